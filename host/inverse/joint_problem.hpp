// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "host/inverse/marginal.hpp"

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
/// What driven walls show of the reference's contours is left out: each target's walls are
/// conditioned on their own distances.
class JointProblem : public ModulusObjective {
public:
    /// Of one reference, with the same priors, at least one; each linearised at its own estimate.
    explicit JointProblem(std::vector<std::shared_ptr<const LinearisedProblem>> targets);

    /// Gradients are central differences.
    Evaluation evaluate(const Eigen::VectorXd& theta, bool with_gradient) const override;
    /// On all cores.
    std::vector<double> objectives(const std::vector<Eigen::VectorXd>& thetas) const override;
    /// Empty: the walls are those of each target.
    Fit fit(const Eigen::VectorXd& theta) const override;
    Eigen::MatrixXd hessian(const Eigen::VectorXd& theta) const override;
    Eigen::MatrixXd seen_information(const Eigen::VectorXd& theta) const override;
    const std::vector<ModulusPrior>& priors() const override { return targets_[0]->priors(); }
    /// What one target tells (the traces' mean) over what all tell, at most 1.
    double share_of_one(const Eigen::VectorXd& theta) const;

private:
    struct Response;
    Response respond(const Eigen::VectorXd& theta) const;
    double value(const Eigen::VectorXd& theta) const;

    std::vector<std::shared_ptr<const LinearisedProblem>> targets_;
    std::vector<Index> first_mode_;  ///< of each target among the modes of all, then their number
    Eigen::MatrixXd information_;    ///< V^T G_o^T R^-1 G_o V, of all targets
    Eigen::VectorXd pull_of_target_;
    double target_misfit_ = 0, noise_log_determinant_ = 0;
};

}  // namespace palpate
