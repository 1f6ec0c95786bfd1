// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/outline_islands.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace palpate {
namespace {

constexpr std::size_t columns_over_island = 45;  // 4 columns of a frame 180 wide
constexpr Index below_edge = 6, gap_rows = 3;    // blur is left behind; rows of background
constexpr float gap_sigmas = 3, gap_part = 0.4F, floating_part = 0.6F;
constexpr Index fall_rows = 6;
constexpr float fall_factor = 1.4F;
constexpr double floating_sd = 2;  // rows, at least
constexpr std::size_t least_points = 20, columns_over_bite = 3;
constexpr double bite_depth = 2.5, bite_edge = 1, above_visible = 6;  // rows

/// Of columns from `from` on, in steps of `step`, that are doubted one after the other.
std::size_t doubted_run(const Outline& outline, std::ptrdiff_t from, std::ptrdiff_t step) {
    std::size_t count = 0;
    for (std::ptrdiff_t x = from;
         x >= 0 && x < std::ptrdiff_t(outline.size()) && is_doubted(outline[std::size_t(x)].flag);
         x += step)
        ++count;
    return count;
}

/// Whether some rows below the outline are background, which begins directly below its blur or
/// with a fall of light: where tissue grows dark with depth light falls slowly.
bool is_over_gap(const BeyondBackground& beyond, Index x, double row) {
    const float* grey = &beyond.grey[std::size_t(x * beyond.stride)];
    const float most =
        std::max(gap_sigmas * beyond.sigma, gap_part * beyond.tissue[std::size_t(x)]);
    const Index first = Index(std::ceil(row)) + below_edge;
    Index run = 0, y = first;
    for (; y < beyond.rows && run < gap_rows; ++y) run = std::abs(grey[y]) < most ? run + 1 : 0;
    if (run < gap_rows) return false;
    const Index begin = y - gap_rows;
    return begin == first || *std::max_element(grey + std::max(first, begin - fall_rows),
                                               grey + begin) > fall_factor * most;
}

}  // namespace

void flag_islands(Outline& outline) {
    const Outline before = outline;
    const std::size_t most = std::max<std::size_t>(2, outline.size() / columns_over_island);
    for (std::size_t begin = 0, end = 0; begin < before.size(); begin = end) {
        end = begin + 1;
        if (before[begin].flag != PointFlag::ok) continue;
        while (end < before.size() && before[end].flag == PointFlag::ok) ++end;
        const std::size_t length = end - begin;
        if (length > most) continue;
        const std::size_t left = doubted_run(before, std::ptrdiff_t(begin) - 1, -1),
                          right = doubted_run(before, std::ptrdiff_t(end), 1);
        if (left == 0 || right == 0 || left + right <= 2 * length) continue;
        for (std::size_t x = begin; x < end; ++x) {
            outline[x].flag = PointFlag::guessed;
            outline[x].sd = std::max({outline[x].sd, before[begin - 1].sd, before[end].sd});
        }
    }
}

void flag_floating(const BeyondBackground& beyond, Outline& outline) {
    for (bool has_changed = true; has_changed;) {
        has_changed = false;
        for (std::size_t begin = 0, end = 0; begin < outline.size(); begin = end) {
            end = begin + 1;
            if (outline[begin].flag != PointFlag::ok) continue;
            while (end < outline.size() && outline[end].flag == PointFlag::ok) ++end;
            const std::size_t doubted = doubted_run(outline, std::ptrdiff_t(begin) - 1, -1) +
                                        doubted_run(outline, std::ptrdiff_t(end), 1);
            if (doubted < end - begin) continue;
            std::size_t count = 0;
            for (std::size_t x = begin; x < end; ++x)
                count += is_over_gap(beyond, Index(x), outline[x].row);
            if (float(count) < floating_part * float(end - begin)) continue;
            has_changed = true;
            for (std::size_t x = begin; x < end; ++x) {
                outline[x].flag = PointFlag::guessed;
                outline[x].sd = std::max(outline[x].sd, floating_sd);
            }
        }
    }
}

void flag_bites(double visible_rows, Outline& outline) {
    std::vector<std::size_t> columns, hull;  // hull: of the points from above
    for (std::size_t x = 0; x < outline.size(); ++x)
        if (outline[x].flag == PointFlag::ok && outline[x].row < visible_rows - 1)
            columns.push_back(x);
    if (columns.size() < least_points) return;
    const auto line_at = [&](std::size_t from, std::size_t to, std::size_t x) {
        const double share = double(x - from) / double(to - from);
        return outline[from].row + share * (outline[to].row - outline[from].row);
    };
    for (const std::size_t x : columns) {
        while (hull.size() >= 2 &&
               line_at(hull[hull.size() - 2], x, hull.back()) <= outline[hull.back()].row)
            hull.pop_back();
        hull.push_back(x);
    }
    for (std::size_t k = 1; k < hull.size(); ++k) {
        const std::size_t from = hull[k - 1], to = hull[k];
        if (to - from > outline.size() / columns_over_bite ||
            std::max(outline[from].row, outline[to].row) > visible_rows - above_visible)
            continue;
        const auto depth = [&](std::size_t x) {
            return outline[x].flag == PointFlag::ok ? outline[x].row - line_at(from, to, x) : 0.0;
        };
        double deepest = 0;
        for (std::size_t x = from + 1; x < to; ++x) deepest = std::max(deepest, depth(x));
        if (deepest <= bite_depth) continue;
        for (std::size_t x = from + 1; x < to; ++x)
            if (const double below = depth(x); below > bite_edge) {
                outline[x].flag = PointFlag::guessed;
                outline[x].sd = std::max(outline[x].sd, below);
            }
    }
}

}  // namespace palpate
