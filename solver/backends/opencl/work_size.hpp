// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

/// Our own ceilings: drivers such as PoCL allow far more than a GPU does. No kernel of ours uses
/// local memory today; one that does must stay below 32 KiB.
constexpr std::size_t max_work_group_items = 256;
constexpr std::size_t max_local_bytes = 32 * 1024;

/// Work-group shape: items along columns (dimension 0) and along rows (dimension 1).
struct WorkGroup {
    std::size_t columns = 1;
    std::size_t rows = 64;
};

/// Items of a launch, rounded up to whole work groups.
struct WorkSize {
    std::size_t column_groups = 1;
    std::size_t rows = 0;
    WorkGroup group;

    static std::size_t round_up(std::size_t count, std::size_t unit) {
        return (count + unit - 1) / unit * unit;
    }
    std::size_t global_columns() const { return round_up(column_groups, group.columns); }
    std::size_t global_rows() const { return round_up(rows, group.rows); }
};

/// Columns [first, first + width * groups) handled by work items of `width` columns each.
struct ColumnPass {
    std::size_t first = 0;
    std::size_t groups = 0;
    int width = 1;
};

/// Cuts any number of columns into passes. A CPU takes vectors of up to `max_width` columns (16, 8,
/// 4, then single ones), one vector after the other, so that a pass finds its rows in the cache;
/// elsewhere every item takes one column and neighbours take neighbours.
inline std::vector<ColumnPass> column_passes(std::size_t num_columns, bool is_cpu, int max_width) {
    if (!is_cpu) return {{0, num_columns, 1}};
    std::vector<ColumnPass> passes;
    std::size_t first = 0;
    for (int width : {16, 8, 4, 1}) {
        if (width > max_width) continue;
        if (width == 1 && first < num_columns) passes.push_back({first, num_columns - first, 1});
        for (; width > 1 && first + width <= num_columns; first += width)
            passes.push_back({first, 1, width});
    }
    return passes;
}

}  // namespace palpate
