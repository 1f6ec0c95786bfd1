// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/outline_search.hpp"

#include <algorithm>
#include <cmath>

#include "solver/base/multiversion.hpp"

namespace palpate {
namespace {

constexpr float unreachable = 1e9F;
constexpr Index reach = OutlineSearch::reach;

float least_of(float a, float b) { return a < b ? a : b; }

/// min over d of from[y + d] + bend[d], counted from 0.
inline float best_step(const float* from, const OutlineSearch::Bend& bend, Index y) {
    static_assert(reach == 4);
    return least_of(least_of(least_of(least_of(from[y] + bend[0], from[y + 1] + bend[1]),
                                      least_of(from[y + 2] + bend[2], from[y + 3] + bend[3])),
                             least_of(least_of(from[y + 4] + bend[4], from[y + 5] + bend[5]),
                                      least_of(from[y + 6] + bend[6], from[y + 7] + bend[7]))),
                    from[y + 8] + bend[8]);
}

/// The next column of F or G, `reach` rows after the begin of `from` and `out`; returns its least.
PALPATE_MULTIVERSION
float step_forward(const float* from, OutlineSearch::Bend bend, const float* cost, Index rows,
                   float* out) {
    float least = unreachable;
    for (Index y = 0; y < rows; ++y) {
        const float value = best_step(from, bend, y) + cost[y];
        out[y + reach] = value;
        least = least_of(least, value);
    }
    return least;
}

/// The same, and F + G of the column: returns the least of both.
PALPATE_MULTIVERSION
std::array<float, 2> step_back(const float* from, OutlineSearch::Bend bend, const float* cost,
                               const float* forward, Index rows, float* out, float* total) {
    float least = unreachable, least_total = unreachable;
    for (Index y = 0; y < rows; ++y) {
        const float step = best_step(from, bend, y), value = step + cost[y];
        const float sum = step + forward[y + reach];
        out[y + reach] = value;
        total[y] = sum;
        least = least_of(least, value);
        least_total = least_of(least_total, sum);
    }
    return {least, least_total};
}

/// Of values that have grown by `least`, which is taken off again.
OutlineSearch::Bend lower_by(float least, OutlineSearch::Bend bend) {
    for (float& one : bend) one -= least;
    return bend;
}

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
      after_(std::size_t(stride_), unreachable),
      bend_(std::size_t(width)),
      path_(std::size_t(width), 0) {}

void OutlineSearch::set_bend(const std::vector<float>& slope, float weight, float curvature) {
    for (Index x = 0; x < width_; ++x)
        for (Index d = -reach; d <= reach; ++d) {
            const float k = std::abs(float(d) - slope[x]);
            bend_[x][d + reach] = weight * (k + curvature * k * k);
        }
}

// F_x(y) = c_x(y) + min_d F_{x-1}(y - d) + bend_x(d);  G_x(y) = min_d c_{x+1}(y + d) +
// G_{x+1}(y + d) + bend_{x+1}(d);  F + G is the cost of the best path through (x, y).
void OutlineSearch::run() {
    const Index rows = rows_;
    std::copy_n(cost_.begin(), rows, forward_.begin() + reach);
    float least = *std::min_element(cost_.begin(), cost_.begin() + rows);
    for (Index x = 1; x < width_; ++x) {
        Bend down;  // a step of d rows to y began at y - d
        std::reverse_copy(bend_[x].begin(), bend_[x].end(), down.begin());
        least = step_forward(&forward_[(x - 1) * stride_], lower_by(least, down),
                             &cost_[x * stride_], rows, &forward_[x * stride_]);
    }
    Bend bend{};  // behind the last column all is free
    std::fill_n(next_.begin() + reach, rows, 0.0F);
    least = 0;
    for (Index x = width_ - 1; x >= 0; --x) {
        float* total = &total_[x * stride_];
        const auto [least_next, least_total] =
            step_back(next_.data(), lower_by(least, bend), &cost_[x * stride_],
                      &forward_[x * stride_], rows, after_.data(), total);
        next_.swap(after_);
        least = least_next;
        bend = bend_[x];
        // The best path goes no farther from column to column
        const Index from = x + 1 < width_ ? std::max<Index>(0, path_[x + 1] - reach) : 0;
        const Index to = x + 1 < width_ ? std::min(rows, path_[x + 1] + reach + 1) : rows;
        const float* const near = std::find(total + from, total + to, least_total);
        path_[x] = (near < total + to ? near : std::find(total, total + rows, least_total)) - total;
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
