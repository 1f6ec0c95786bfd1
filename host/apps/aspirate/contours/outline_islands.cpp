// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/outline_islands.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace palpate {
namespace {

constexpr std::size_t columns_over_island = 45;  // 4 columns of a frame 180 wide
constexpr Index below_edge = 6, gap_rows = 3;    // blur is left behind; rows of background
constexpr float gap_sigmas = 3, gap_part = 0.4F, floating_part = 0.6F;
constexpr double floating_sd = 2;  // rows, at least

/// Of columns from `from` on, in steps of `step`, that are doubted one after the other.
std::size_t doubted_run(const Outline& outline, std::ptrdiff_t from, std::ptrdiff_t step) {
    std::size_t count = 0;
    for (std::ptrdiff_t x = from;
         x >= 0 && x < std::ptrdiff_t(outline.size()) && is_doubted(outline[std::size_t(x)].flag);
         x += step)
        ++count;
    return count;
}

/// Whether some rows below the outline are background.
bool is_over_gap(const BeyondBackground& beyond, Index x, double row) {
    const float* grey = &beyond.grey[std::size_t(x * beyond.stride)];
    const float most =
        std::max(gap_sigmas * beyond.sigma, gap_part * beyond.tissue[std::size_t(x)]);
    Index run = 0;
    for (auto y = Index(std::ceil(row)) + below_edge; y < beyond.rows && run < gap_rows; ++y)
        run = std::abs(grey[y]) < most ? run + 1 : 0;
    return run == gap_rows;
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

}  // namespace palpate
