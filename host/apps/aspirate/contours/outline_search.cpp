// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/outline_search.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr float unreachable = 1e9F;

}  // namespace

// A column has `reach` unreachable rows before and behind it, so that loops need no ends.
OutlineSearch::OutlineSearch(Index width, Index rows)
    : width_(width),
      rows_(rows),
      stride_((rows + 2 * reach + 7) / 8 * 8),
      cost_(std::size_t(width * stride_), 0.0F),
      forward_(std::size_t(width * stride_), unreachable),
      total_(std::size_t(width * stride_), unreachable),
      next_(std::size_t(stride_), unreachable),
      spread_(std::size_t(stride_), unreachable),
      bend_(std::size_t(width)),
      path_(std::size_t(width), 0) {}

void OutlineSearch::set_bend(const std::vector<float>& slope, float weight, float curvature) {
    for (Index x = 0; x < width_; ++x)
        for (Index d = -reach; d <= reach; ++d) {
            const float k = std::abs(float(d) - slope[x]);
            bend_[x][d + reach] = weight * (k + curvature * k * k);
        }
}

void OutlineSearch::spread(const float* from, const std::array<float, 2 * reach + 1>& bend,
                           Index sign, float* out) const {
    const Index rows = rows_;
    const float* middle = from + reach;
    float* const result = out + reach;
    for (Index y = 0; y < rows; ++y) result[y] = middle[y] + bend[reach];
    for (Index d = -reach; d <= reach; ++d) {
        if (d == 0) continue;
        const float added = bend[d + reach];
        const float* moved = middle - sign * d;
        for (Index y = 0; y < rows; ++y) {
            const float value = moved[y] + added;
            result[y] = value < result[y] ? value : result[y];
        }
    }
}

// F_x(y) = c_x(y) + min_d F_{x-1}(y - d) + bend_x(d);  G_x(y) = min_d c_{x+1}(y + d) +
// G_{x+1}(y + d) + bend_{x+1}(d);  F + G is the cost of the best path through (x, y).
void OutlineSearch::run() {
    const Index rows = rows_;
    for (Index x = 0; x < width_; ++x) {
        float* f = &forward_[x * stride_];
        const float* c = &cost_[x * stride_];
        if (x == 0) {
            for (Index y = 0; y < rows; ++y) f[y + reach] = c[y];
            continue;
        }
        spread(&forward_[(x - 1) * stride_], bend_[x], 1, f);
        float least = unreachable;
        for (Index y = 0; y < rows; ++y) {
            f[y + reach] += c[y];
            least = f[y + reach] < least ? f[y + reach] : least;
        }
        for (Index y = 0; y < rows; ++y) f[y + reach] -= least;
    }
    std::fill(spread_.begin(), spread_.end(), unreachable);
    std::fill(next_.begin(), next_.end(), unreachable);
    for (Index y = 0; y < rows; ++y) spread_[y + reach] = 0;
    for (Index x = width_ - 1; x >= 0; --x) {
        if (x + 1 < width_) spread(next_.data(), bend_[x + 1], -1, spread_.data());
        float* t = &total_[x * stride_];
        const float* f = &forward_[x * stride_];
        const float* c = &cost_[x * stride_];
        float least = unreachable;
        for (Index y = 0; y < rows; ++y) {
            t[y] = f[y + reach] + spread_[y + reach];
            const float value = spread_[y + reach] + c[y];
            next_[y + reach] = value;
            least = value < least ? value : least;
        }
        for (Index y = 0; y < rows; ++y) next_[y + reach] -= least;
        path_[x] = std::min_element(t, t + rows) - t;
    }
}

void OutlineSearch::margins(Index far, std::vector<float>& margin) const {
    for (Index x = 0; x < width_; ++x) {
        const float* t = &total_[x * stride_];
        const Index low = path_[x] - far, high = path_[x] + far + 1;
        float least = unreachable;
        for (Index y = 0; y < low; ++y) least = t[y] < least ? t[y] : least;
        for (Index y = high; y < rows_; ++y) least = t[y] < least ? t[y] : least;
        margin[x] = least - t[path_[x]];
    }
}

}  // namespace palpate
