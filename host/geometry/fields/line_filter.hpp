// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "solver/base/parallel.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// Lines that are filtered together: neighbours in memory, so that loops over them vectorise.
constexpr Index lines_per_block = 16;

/// Applies filter(block, length) to all lines of a volume along one axis, in place and in parallel.
///   volume  [size[0] * size[1] * size[2]], index 0 fastest
///   block   [length][lines_per_block]; unused lines hold zeros
template <typename Filter>
void filter_lines(const std::array<Index, 3>& size, int axis, std::vector<float>& volume,
                  const Filter& filter) {
    const std::array<std::size_t, 3> stride{1, std::size_t(size[0]),
                                            std::size_t(size[0]) * std::size_t(size[1])};
    const int across = axis == 0 ? 1 : 0;  // lines of a block are neighbours along this axis
    const int outer = 3 - axis - across;
    const Index length = size[axis];
    const Index blocks_per_row = (size[across] + lines_per_block - 1) / lines_per_block;
    const std::size_t num_blocks = std::size_t(blocks_per_row) * std::size_t(size[outer]);
    parallel_ranges(num_blocks, 1, [&](std::size_t begin, std::size_t end) {
        std::vector<float> block(std::size_t(length) * lines_per_block, 0.f);
        for (std::size_t b = begin; b < end; ++b) {
            const Index first = Index(b % blocks_per_row) * lines_per_block;
            const Index width = std::min(lines_per_block, size[across] - first);
            float* origin = volume.data() + std::size_t(first) * stride[across] +
                            (b / blocks_per_row) * stride[outer];
            for (Index k = 0; k < length; ++k) {
                for (Index w = 0; w < width; ++w) {
                    block[k * lines_per_block + w] = origin[k * stride[axis] + w * stride[across]];
                }
            }
            filter(block.data(), length);
            for (Index k = 0; k < length; ++k) {
                for (Index w = 0; w < width; ++w) {
                    origin[k * stride[axis] + w * stride[across]] = block[k * lines_per_block + w];
                }
            }
        }
    });
}

}  // namespace palpate
