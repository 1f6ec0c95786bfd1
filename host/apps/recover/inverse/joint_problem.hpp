// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "host/apps/recover/inverse/linearised_problem.hpp"

namespace palpate {

/// Several targets of one reference as one inverse problem for its moduli: each target has walls
/// and contours of its own, the contours of the reference are in all of them. Of two images' error
/// half the variance is the reference's, so that with the rows a and b of two targets
///   R_ab = 1/2 D_a K D_b   (and R_aa as in LinearisedProblem),
/// D the standard deviation of each row's contours, K their correlation along the reference's
/// surfaces. Where the moduli change what is seen in the same direction, N targets tell 2N / (N +
/// 1) times as much as one; where organs moved to both sides, the reference's error cancels.
///   F(theta) = 1/2 e^T C^-1 e + 1/2 ln det C + 1/2 |(theta - theta_0)/sd|^2,   C = R + B B^T,
/// with e, and B block by block, those of the targets.
///
/// With what the reference's contours are as an unknown of its own, [places of the reference],
/// targets are independent, so that work and memory grow as the number of targets.
///
/// What driven walls show of the reference's contours is left out: each target's walls are
/// conditioned on their own distances. So are the reference's voxels: their noise counts as
/// independent.
class JointProblem : public Objective {
public:
    /// Of one reference, with the same unknowns, at least one; each linearised at its own estimate.
    explicit JointProblem(const std::vector<std::shared_ptr<const LinearisedProblem>>& targets);
    ~JointProblem() override;

    /// Gradients are central differences.
    Evaluation evaluate(const Eigen::VectorXd& theta, bool with_gradient) const override;
    /// On all cores.
    std::vector<double> objectives(const std::vector<Eigen::VectorXd>& thetas) const override;
    Eigen::MatrixXd hessian(const Eigen::VectorXd& theta) const override;
    Eigen::MatrixXd seen_information(const Eigen::VectorXd& theta) const override;
    const std::vector<Unknown>& unknowns() const override;
    /// What each target alone tells of each modulus over what all tell, at most 1:
    /// [targets, unknown].
    Eigen::MatrixXd shares(const Eigen::VectorXd& theta) const;

private:
    struct Target;
    struct Response;
    Response respond(const Eigen::VectorXd& theta) const;
    double value(const Eigen::VectorXd& theta) const;

    std::vector<Target> targets_;
    Eigen::MatrixXd common_information_;  ///< 1 + sum of U^T B^-1 U
    double noise_log_determinant_ = 0;    ///< of all B
};

}  // namespace palpate
