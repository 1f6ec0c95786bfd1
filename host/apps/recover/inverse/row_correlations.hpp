// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "host/apps/recover/inverse/linear_row.hpp"

namespace palpate {

/// What the noise of the rows of one surface shares, pair by pair. Places of rows do not change
/// through a search, so that the exponentials of all pairs are computed once; 8 n^2 bytes for each
/// of k(d), slice_correlation and the ranges of terraces that differ.
class RowCorrelations {
public:
    /// Rows of one surface; their `place`, `slices` and `range_mm` count.
    explicit RowCorrelations(const std::vector<LinearRow>& rows);

    /// As noise_covariance of rows that are not known: `place_in_known` says which these are, all
    /// else may have changed.
    double noise_covariance(const LinearRow& a, const LinearRow& b) const;

private:
    Eigen::MatrixXd smooth_, by_slice_;
    std::vector<Eigen::MatrixXd> decay_;  ///< exp(-d / range) for each range
    std::array<int, max_terraces> decay_of_wave_{};
};

/// Gives each row the correlations of its surface. Rows on driven nodes and on observed ones have
/// their own.
void remember_correlations(std::vector<LinearRow>& rows);

}  // namespace palpate
