// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cstdint>
#include <vector>

#include "host/inverse/linear_row.hpp"
#include "host/objectives/surface_observations.hpp"

namespace palpate {

/// How large the parts of the noise are that the images do not give.
struct NoiseLevel {
    double scale = 1;  ///< factor on the independent part, sigma_n
    /// Standard deviation (mm) of what whoever drew the contours added, both images together.
    double contour_mm = 0;
};

/// The noise of all observations: independent and correlated parts, and what becomes of outliers.
/// Residuals beyond three standard deviations count linearly (Huber): a wrong label, a kink of the
/// target or a distance far larger than a voxel must neither dominate nor stall the search.
class SurfaceNoise {
public:
    explicit SurfaceNoise(const SurfaceObservations& observations);

    /// The same as `update` without terraces, before anything is known of where surfaces come to.
    void start(const NoiseLevel& level);
    /// Terraces follow from the voxels, for the surfaces where `state` has them; at first there are
    /// none.
    void update(const NoiseLevel& level, const ObservedState& state);
    const NoiseLevel& level() const { return level_; }
    /// The contours' standard deviation for which the observed rows would have `factor` times their
    /// variance: s^2 <- f (s^2 + b) - b, b the mean variance of all other parts.
    double contour_mm_for(double factor) const;
    /// 1/2 z^T C^-1 z, z the residuals in standard deviations with outliers pulled in, C the
    /// correlation; over the rows in `counted`.
    double misfit(const Eigen::VectorXd& residual_mm,
                  const std::vector<std::uint8_t>& counted) const;
    /// One row per observation that is seen, the noise of outliers inflated so that the quadratic
    /// loss has the slope of the robust one.
    std::vector<LinearRow> linear_rows(const ObservedState& seen) const;

private:
    void factorise();

    /// Rows of one surface on nodes of one kind; others are independent of them.
    struct Group {
        std::vector<Index> rows;
        Eigen::LLT<Eigen::MatrixXd> correlation;
    };

    const SurfaceObservations* observations_;
    NoiseLevel level_;
    std::vector<LinearRow> rows_;  ///< without normals and residuals
    std::vector<double> sigma_mm_;
    std::vector<Group> groups_;
};

}  // namespace palpate
