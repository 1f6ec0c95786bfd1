// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "host/apps/recover/inverse/contour_kernel.hpp"
#include "host/apps/recover/inverse/row_correlations.hpp"
#include "host/apps/recover/observations/target_frame.hpp"
#include "host/apps/recover/observations/voxel_terraces.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// One surface distance, linearised: residual + normal . (u - u_linearised), with noise that is in
/// part independent from row to row and in part correlated along the surface.
struct LinearRow {
    bool on_driven = false;
    Index position = 0;  ///< of its node among the driven or the observed nodes
    Vec3 normal = Vec3::Zero();
    double residual_mm = 0;
    double independent_mm = 1;  ///< standard deviation of the independent part
    Terraces terraces;          ///< the part that is correlated along the terraces of voxels
    double contour_mm = 0;      ///< standard deviation of the part that whoever drew it adds
    double slice_share = 0;     ///< of its variance: as drawn slice by slice
    SlicePlaces slices;
    Index surface = 0;          ///< rows of different surfaces have independent noise
    Vec3 place = Vec3::Zero();  ///< of the node, reference, mm
    std::array<double, max_terraces> range_mm{};  ///< the correlation of each wave falls to 1/e
    double weight = 1;  ///< in sums that the size of the noise is found from; less for outliers
    /// Correlations of its surface, as far as they were computed, and its place there.
    std::shared_ptr<const RowCorrelations> known = {};
    Index place_in_known = 0;
};

/// The target's alignment as an unknown of its own: delta ~ N(0, covariance).
struct FramePrior {
    using Covariance = Eigen::Matrix<double, 6, 6>;
    TargetFrame frame;
    Covariance covariance = Covariance::Zero();  ///< zero: it is exact
    FrameMotion motion = FrameMotion::Zero();    ///< delta at which rows are linearised

    Index size() const { return covariance.isZero(0) ? 0 : 6; }
};

/// Correlation of what contours of one surface are off by at two of its rows, relative to
/// `contour_mm`: (1 - share) k(d) + share slice_correlation.
double contour_correlation(const LinearRow& a, const LinearRow& b);

/// Covariance (mm^2) that terraces of voxels give two rows of one surface, exponential in their
/// distance.
double terrace_covariance(const LinearRow& a, const LinearRow& b, double distance);

/// Covariance (mm^2) between the noise of two different rows: that of contours, and of terraces.
double noise_covariance(const LinearRow& a, const LinearRow& b);

/// What contours add (mm^2).
double contour_variance(const LinearRow& row);

/// Of the parts (mm^2) that a row shares with its neighbours.
double correlated_variance(const LinearRow& row);

double noise_variance(const LinearRow& row);

/// Gives each row the correlations of its surface; rows on driven nodes and on observed ones have
/// their own.
void remember_correlations(std::vector<LinearRow>& rows);

/// R [num rows, num rows] mm^2: the noise of all rows.
Eigen::MatrixXd noise_matrix(const std::vector<LinearRow>& rows);

}  // namespace palpate
