// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/fields/gaussian_smoothing.hpp"

#include <algorithm>
#include <cmath>

#include "host/geometry/fields/line_filter.hpp"

namespace palpate {
namespace {

/// [radius + 1]: the middle, then each side; they sum to one with both sides.
std::vector<float> half_kernel(double sd) {
    const int radius = static_cast<int>(std::ceil(3.0 * sd));
    std::vector<double> weights;
    double sum = 0;
    for (int k = 0; k <= radius; ++k) {
        weights.push_back(std::exp(-0.5 * k * k / (sd * sd)));
        sum += k == 0 ? weights.back() : 2.0 * weights.back();
    }
    std::vector<float> kernel;
    for (const double weight : weights) kernel.push_back(static_cast<float>(weight / sum));
    return kernel;
}

}  // namespace

void smooth_gaussian(const std::array<Index, 3>& size, double sd, std::vector<float>& volume) {
    if (!(sd > 0)) return;
    const std::vector<float> kernel = half_kernel(sd);
    for (int axis = 0; axis < 3; ++axis) {
        filter_lines(size, axis, volume, [&](float* block, Index length) {
            const std::vector<float> line(block, block + length * lines_per_block);
            for (Index k = 0; k < length; ++k) {
                float* here = block + k * lines_per_block;
                for (Index w = 0; w < lines_per_block; ++w)
                    here[w] = kernel[0] * line[k * lines_per_block + w];
                for (Index r = 1; r < static_cast<Index>(kernel.size()); ++r) {
                    const float* before = &line[std::max<Index>(0, k - r) * lines_per_block];
                    const float* after = &line[std::min(length - 1, k + r) * lines_per_block];
                    for (Index w = 0; w < lines_per_block; ++w)
                        here[w] += kernel[r] * (before[w] + after[w]);
                }
            }
        });
    }
}

}  // namespace palpate
