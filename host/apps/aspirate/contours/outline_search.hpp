// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// The best path through a frame from left to right, one row for each column, exactly: dynamic
/// programming over the columns in both directions (Viterbi), which gives for each row of each
/// column the cost of the best path through it.
class OutlineSearch {
public:
    static constexpr Index reach = 4;               ///< rows from column to column, at most
    using Bend = std::array<float, 2 * reach + 1>;  ///< costs of a step of -reach to reach rows

    /// `rows` of each column can be chosen.
    OutlineSearch(Index width, Index rows);

    Index stride() const { return stride_; }
    /// Cost of row y in column x, to be filled: [width][stride].
    std::vector<float>& cost() { return cost_; }
    /// Of a path's slope (rows per column) that differs from `slope` [width], from the column
    /// before: k + curvature k^2 for a difference of k rows, times `weight`.
    void set_bend(const std::vector<float>& slope, float weight, float curvature);

    void run();
    /// Of the best path [width].
    const std::vector<Index>& path() const { return path_; }
    /// How much more the best path costs that is more than `far` rows away in the column [width].
    void margins(Index far, std::vector<float>& margin) const;

private:
    Index width_, rows_, stride_;
    std::vector<float> cost_, forward_, total_, next_, after_;
    std::vector<Bend> bend_;
    std::vector<Index> path_;
};

}  // namespace palpate
