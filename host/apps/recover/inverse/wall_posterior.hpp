// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "host/apps/recover/inverse/linear_row.hpp"
#include "host/apps/recover/inverse/wall_prior.hpp"

namespace palpate {

/// The driven walls' motion given the distances of the walls alone, linearised: N(m, H^-1) with
///   H = Q + G^T R^-1 G,   H^-1 = S - S G^T (R + G S G^T)^-1 G S,   S = Q^-1
/// (Gaussian conditioning; Rasmussen and Williams 2006, eq. 2.23). G has one normal per row, so
/// G S G^T is the prior's covariance between nodes times the cosine between their normals.
///
/// That is given the target's alignment. If that is unknown, delta ~ N(0, Sigma), a row shows
/// G u + A delta, and with K = R + G S G^T and the distances y
///   m = S G^T K^-1 y - D delta,   D = S G^T K^-1 A,
///   delta ~ N(M^-1 A^T K^-1 y, M^-1),   M = Sigma^-1 + A^T K^-1 A.
class WallPosterior {
public:
    /// `rows` linearised at the driven displacement `driven` [3 num_driven]; rows on observed nodes
    /// are left out. `prior` must outlive this object.
    WallPosterior(const WallPrior& prior, const std::vector<LinearRow>& rows,
                  const Eigen::VectorXd& driven, const FramePrior& frame = {});

    /// m at the mean of delta.
    const Eigen::VectorXd& mean() const { return mean_; }
    const FrameMotion& frame_mean() const { return frame_mean_; }
    /// L [6, 6] with L L^T = M^-1; empty if the alignment is exact.
    const Eigen::MatrixXd& frame_root() const { return frame_root_; }
    /// D [3 num_driven, 6], or [3 num_driven, 0].
    const Eigen::MatrixXd& frame_spread() const { return frame_spread_; }
    /// N H^-1 N^T, the alignment held, for functionals N given as `spread` = Q^-1 N^T [3
    /// num_driven, k] and `prior_covariance` = N Q^-1 N^T [k, k].
    Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& spread,
                                  const Eigen::MatrixXd& prior_covariance) const;
    /// H^-1 v, given Q^-1 v, the alignment held.
    Eigen::VectorXd conditioned(const Eigen::VectorXd& prior_times_v) const;

private:
    struct Rows {
        const WallPrior::Wall* wall;
        std::vector<Index> place;  ///< of each row's node in the wall
        std::vector<LinearRow> rows;
        Eigen::LLT<Eigen::MatrixXd> gram;  ///< of K
        Eigen::VectorXd wanted;            ///< y
    };
    void condition(Rows& part, const Eigen::VectorXd& driven, const FramePrior& frame);
    void find_frame(const FramePrior& frame);
    void add_spread_back(const Rows& part, const Eigen::MatrixXd& weights, double scale,
                         Eigen::Ref<Eigen::MatrixXd> result) const;

    const WallPrior& prior_;
    std::vector<Rows> parts_;
    Eigen::VectorXd mean_;
    FrameMotion frame_mean_ = FrameMotion::Zero();
    Eigen::MatrixXd frame_root_, frame_spread_;
};

}  // namespace palpate
