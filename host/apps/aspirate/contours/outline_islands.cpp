// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/outline_islands.hpp"

#include <algorithm>
#include <cstddef>

namespace palpate {
namespace {

constexpr std::size_t columns_over_island = 45;  // 4 columns of a frame 180 wide

/// Of columns from `from` on, in steps of `step`, that are doubted one after the other.
std::size_t doubted_run(const Outline& outline, std::ptrdiff_t from, std::ptrdiff_t step) {
    std::size_t count = 0;
    for (std::ptrdiff_t x = from;
         x >= 0 && x < std::ptrdiff_t(outline.size()) && is_doubted(outline[std::size_t(x)].flag);
         x += step)
        ++count;
    return count;
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

}  // namespace palpate
