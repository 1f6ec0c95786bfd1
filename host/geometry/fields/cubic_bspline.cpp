// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/fields/cubic_bspline.hpp"

#include <cmath>

#include "host/geometry/fields/line_filter.hpp"

namespace palpate {
namespace {

constexpr float pole = -0.26794919243112270f;  // sqrt(3) - 2

/// Causal and anticausal recursion along one block of lines, mirrored at both ends.
void prefilter_block(float* block, Index length) {
    constexpr Index width = lines_per_block;
    const Index horizon = std::min<Index>(length, 28);  // pole^28 < 1e-15
    std::array<float, width> start{};
    float power = 1;
    for (Index k = 0; k < horizon; ++k, power *= pole) {
        for (Index w = 0; w < width; ++w) start[w] += power * block[k * width + w];
    }
    for (Index w = 0; w < width; ++w) block[w] = 6 * start[w];
    for (Index k = 1; k < length; ++k) {
        float* here = block + k * width;
        for (Index w = 0; w < width; ++w) here[w] = 6 * here[w] + pole * here[w - width];
    }
    float* last = block + (length - 1) * width;
    const float scale = pole / (pole * pole - 1);
    for (Index w = 0; w < width; ++w) last[w] = scale * (pole * last[w - width] + last[w]);
    for (Index k = length - 2; k >= 0; --k) {
        float* here = block + k * width;
        for (Index w = 0; w < width; ++w) here[w] = pole * (here[w + width] - here[w]);
    }
}

struct Weights {
    std::array<float, 4> value, slope;
};

Weights weights_at(double t) {
    const double s = 1 - t;
    Weights weights;
    weights.value = {float(s * s * s / 6), float(2.0 / 3 - t * t * (2 - t) / 2),
                     float(2.0 / 3 - s * s * (2 - s) / 2), float(t * t * t / 6)};
    weights.slope = {float(-s * s / 2), float(1.5 * t * t - 2 * t), float(2 * s - 1.5 * s * s),
                     float(t * t / 2)};
    return weights;
}

}  // namespace

void to_bspline_coefficients(const std::array<Index, 3>& size, std::vector<float>& volume) {
    for (int axis = 0; axis < 3; ++axis) {
        filter_lines(size, axis, volume,
                     [](float* block, Index length) { prefilter_block(block, length); });
    }
}

double bspline_value(const std::array<Index, 3>& size, const float* coefficients, const Vec3& index,
                     Vec3* gradient) {
    std::array<Index, 3> cell;
    std::array<Weights, 3> weights;
    for (int a = 0; a < 3; ++a) {
        cell[a] = std::min(static_cast<Index>(index[a]), size[a] - 3);
        weights[a] = weights_at(index[a] - cell[a]);
    }
    const std::size_t row = size[0], slice = row * std::size_t(size[1]);
    const float* corner = coefficients + (cell[0] - 1) + row * std::size_t(cell[1] - 1) +
                          slice * std::size_t(cell[2] - 1);
    const auto& wx = weights[0];
    float value = 0, slope_x = 0, slope_y = 0, slope_z = 0;
    for (int k = 0; k < 4; ++k) {
        float plane = 0, plane_x = 0, plane_y = 0;
        for (int j = 0; j < 4; ++j) {
            const float* c = corner + j * row + k * slice;
            const float line =
                wx.value[0] * c[0] + wx.value[1] * c[1] + wx.value[2] * c[2] + wx.value[3] * c[3];
            plane += weights[1].value[j] * line;
            if (gradient) {
                const float line_x = wx.slope[0] * c[0] + wx.slope[1] * c[1] + wx.slope[2] * c[2] +
                                     wx.slope[3] * c[3];
                plane_x += weights[1].value[j] * line_x;
                plane_y += weights[1].slope[j] * line;
            }
        }
        value += weights[2].value[k] * plane;
        slope_x += weights[2].value[k] * plane_x;
        slope_y += weights[2].value[k] * plane_y;
        slope_z += weights[2].slope[k] * plane;
    }
    if (gradient) *gradient = Vec3(slope_x, slope_y, slope_z);
    return value;
}

double bspline_derivative(const std::array<Index, 3>& size, const float* coefficients,
                          const Vec3& index, const std::array<int, 3>& orders) {
    std::array<Index, 3> cell;
    std::array<std::array<double, 4>, 3> weights;
    for (int a = 0; a < 3; ++a) {
        cell[a] = std::min(static_cast<Index>(index[a]), size[a] - 3);
        const double t = index[a] - cell[a];
        const Weights w = weights_at(t);
        const std::array<double, 4> curvature{1 - t, 3 * t - 2, 1 - 3 * t, t};
        for (int n = 0; n < 4; ++n) {
            weights[a][n] = orders[a] == 0   ? w.value[n]
                            : orders[a] == 1 ? w.slope[n]
                                             : curvature[n];
        }
    }
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
        for (int j = 0; j < 4; ++j) {
            const float* row = coefficients + (cell[0] - 1) +
                               std::size_t(size[0]) *
                                   ((cell[1] - 1 + j) + std::size_t(size[1]) * (cell[2] - 1 + k));
            for (int i = 0; i < 4; ++i) {
                sum += weights[0][i] * weights[1][j] * weights[2][k] * row[i];
            }
        }
    }
    return sum;
}

}  // namespace palpate
