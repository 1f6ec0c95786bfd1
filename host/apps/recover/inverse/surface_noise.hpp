// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "host/apps/recover/inverse/linear_row.hpp"
#include "host/apps/recover/observations/surface_observations.hpp"

namespace palpate {

/// How large the parts of the noise are that the images do not give.
struct NoiseLevel {
    double scale = 1;  ///< factor on the independent part, sigma_n
    /// Standard deviation (mm) of what whoever drew the contours added, both images together.
    double contour_mm = 0;
    double slice_share = 0;  ///< of its variance: drawn slice by slice (slice_correlation)
};

/// The observations that count and their noise, Gaussian: held through a step, so that no step pays
/// by moving surfaces to where the target does not show them, or by making outliers.
class CountedRows {
public:
    /// 1/2 r^T R^-1 r of the rows that count; `residual_mm` [num observations]. Rows that share
    /// nothing with others are measured by Huber's loss itself.
    double misfit(const Eigen::VectorXd& residual_mm) const;
    /// What is known of the target's frame; its motion is zero.
    const FramePrior& frame() const { return frame_; }
    /// 1/2 delta^T Sigma^-1 delta
    double energy(const FrameMotion& motion) const;
    /// The rows that count, linearised at `seen`, their normals smooth as far as contours are off,
    /// or wholly.
    std::vector<LinearRow> linear_rows(const ObservedState& seen, bool is_smooth = false) const;

private:
    friend class SurfaceNoise;

    /// Rows of one surface on nodes of one kind; others are independent of them.
    struct Group {
        std::vector<Index> observations;
        std::vector<LinearRow> rows;  ///< without normals and residuals
        Eigen::LLT<Eigen::MatrixXd> covariance;
        Eigen::VectorXd alone_mm;  ///< deviations before outliers, where rows share nothing
    };
    static double roughness_to_trust(const Group& group, const ObservedState& seen);

    std::vector<Group> groups_;
    FramePrior frame_;
};

/// The noise of all observations: independent and correlated parts, and what becomes of outliers.
/// A wrong label, a kink of the target or a distance far larger than a voxel must neither dominate
/// nor stall the search: beyond three standard deviations residuals count linearly (Huber), by
/// themselves where they differ from their neighbours and by patches where these share them.
class SurfaceNoise {
public:
    explicit SurfaceNoise(const SurfaceObservations& observations);

    void set_level(const NoiseLevel& level);
    const NoiseLevel& level() const { return level_; }
    /// Terraces follow from the voxels, for the surfaces where `state` has them; at first there are
    /// none.
    void take_terraces(const ObservedState& state);
    /// How far contours are off where the observed rows have `factor` times the variance that they
    /// were said to have.
    struct FoundContours {
        double sd_mm = 0;
        double shown_share = 1;  ///< of the variance: what the rows show, not only leave open
    };
    /// The rows show m = f (s^2 + b) - b, b the mean variance of all other parts. That of voxels is
    /// known to a third, so that s^2 may be m +- b/3 and is not below 0. Of the normal distribution
    /// of this mean and deviation q, cut off at 0, the mean is
    ///   s^2 = m + q phi(m/q) / Phi(m/q).
    FoundContours contours_for(double factor) const;
    /// The rows that `state` sees. The noise of outliers is inflated so that the quadratic loss has
    /// the slope of Huber's:
    ///   alone: z = (R^-1 r)_k / sqrt((R^-1)_kk) is how far a row is from where its neighbours say,
    ///     and its own independent variance grows until its conditional one is |z| / 3 as large;
    ///   by patches: c = S R^-1 r is the smooth part of r, S the correlated part of R, and where
    ///     z = c_k / sqrt(S_kk) is beyond 3 the correlated part is multiplied by sqrt(|z| / 3).
    std::shared_ptr<const CountedRows> count(const ObservedState& state) const;

    /// Covariance of the alignment, which was the least squares of distances with normals n_k at
    /// points x_k: N^-1 (sum_kl a_k R_kl a_l^T) N^-1, N = sum_k a_k a_k^T, a the rows of the frame.
    FramePrior frame() const;

private:
    /// What a group's noise is without outliers, the same until the level or the terraces change.
    struct Plain {
        std::vector<Index> observations;
        Eigen::MatrixXd shared;  ///< S
        Eigen::LLT<Eigen::MatrixXd> covariance;
        Eigen::VectorXd precision;  ///< diagonal of R^-1
    };
    using Surface = std::pair<Index, bool>;  ///< and whether its nodes are driven

    void read_frame(const FrameEvidence& evidence);
    static Plain plain(const CountedRows::Group& group);
    static CountedRows::Group inflated(CountedRows::Group group, const Plain& plain,
                                       const Eigen::VectorXd& residual);

    const SurfaceObservations* observations_;
    NoiseLevel level_;
    mutable std::map<Surface, std::shared_ptr<const Plain>> plain_;  ///< of the last count
    std::vector<LinearRow> rows_;  ///< without normals and residuals
    /// Parts of the frame's covariance: of unit independent noise, of terraces, of unit contours.
    FramePrior::Covariance by_points_, by_terraces_, by_contours_;
};

}  // namespace palpate
