// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "host/apps/recover/inverse/contour_kernel.hpp"
#include "host/apps/recover/observations/voxel_terraces.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// How the noise of the rows of one surface is correlated, pair by pair. Places of rows do not
/// change through a search, so that the exponentials of all pairs are computed once; 8 n^2 bytes
/// for each of k(d), slice_correlation and the ranges of terraces that differ.
class RowCorrelations {
public:
    /// `places`: of the rows, mm. `slices`: where each lies among the slices. `range_mm`: where the
    /// correlation of each wave of terraces falls to 1/e.
    RowCorrelations(const std::vector<Vec3>& places, const std::vector<SlicePlaces>& slices,
                    const std::array<double, max_terraces>& range_mm);

    /// (1 - share) k(d) + share slice_correlation.
    double of_contours(Index a, Index b, double slice_share) const {
        if (slice_share == 0) return smooth_(a, b);
        return (1.0 - slice_share) * smooth_(a, b) + slice_share * by_slice_(a, b);
    }
    /// exp(-d / range) of one wave of terraces.
    double of_terraces(Index a, Index b, int wave) const {
        return decay_[decay_of_wave_[wave]](a, b);
    }

private:
    Eigen::MatrixXd smooth_, by_slice_;
    std::vector<Eigen::MatrixXd> decay_;  ///< for each range
    std::array<int, max_terraces> decay_of_wave_{};
};

}  // namespace palpate
