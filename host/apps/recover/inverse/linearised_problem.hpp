// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/apps/recover/inverse/linear_row.hpp"
#include "host/apps/recover/inverse/response_model.hpp"
#include "host/apps/recover/inverse/wall_posterior.hpp"
#include "host/estimate/objective.hpp"

namespace palpate {

/// The distances of one target's observed surfaces, linearised.
struct ObservedRows {
    std::vector<LinearRow> rows;
    Eigen::MatrixXd along_modes;  ///< G_o V [rows, modes]
    Eigen::VectorXd target;       ///< y [rows] mm
};

/// The inverse problem with the surface distances linearised at one driven displacement, and the
/// driven displacement integrated out.
///
/// With u_d ~ N(m, H^-1) (prior and driven observations; independent of the moduli) and
/// y = J N u_d + noise, the observed rows give for theta = ln E
///   F(theta) = 1/2 e^T C^-1 e + 1/2 ln det C + 1/2 |(theta - theta_0)/sd|^2,
///   e = y - J N m,   C = R + J N H^-1 N^T J^T,   J = -G_o V S(E)^-1 T(E)
/// (Gaussian process regression; Rasmussen and Williams 2006, eq. 2.30; V, S, T, N as in
/// ResponseModel; of mechanics linearised at (u_d*, u_o*) y is less G_o u_o*, and J N m is
/// J N (m - u_d*) - G_o V S^-1 g). The determinant is what a joint minimum over (u_d, theta) lacks:
/// without it soft tissue, which can follow any noise, is always preferred and the modulus comes
/// out too low.
///
/// A motion delta of the target's frame is integrated out with the walls' (WallPosterior): the rows
/// are y = J N u_d + A delta + noise, and delta a wall motion that moves what is seen rigidly. It
/// is kept as six further modes behind those of the response model, which no modulus changes.
class LinearisedProblem : public Objective {
public:
    struct Fit {
        Eigen::VectorXd driven;                   ///< most probable u_d at theta [driven_dofs]
        FrameMotion frame = FrameMotion::Zero();  ///< and motion of the target's frame
        double weighted_misfit = 0;      ///< r^T R^-1 r of the observed residual r = R C^-1 e there
        double effective_rows = 0;       ///< trace of R C^-1: rows that the fit does not use up
        double misfit_mm2 = 0;           ///< r^T D r, D the weights of the rows
        double expected_misfit_mm2 = 0;  ///< its mean if R is right: trace of D R C^-1 R
        double slice_share = 0;          ///< of the contours' noise that r shows (slice_share_of)
    };

    /// `driven` [driven_dofs] and `observed` [observed_dofs]: the displacement at which `rows` are
    /// linearised. `model` and `prior` must outlive this object.
    LinearisedProblem(const ResponseModel& model, const WallPrior& prior,
                      const std::vector<LinearRow>& rows, const Eigen::VectorXd& driven,
                      const Eigen::VectorXd& observed, const std::vector<Unknown>& unknowns,
                      const FramePrior& frame = {});

    /// F is infinite where the mechanics are not stable: mechanics linearised at a deformed state
    /// are near it.
    Evaluation evaluate(const Eigen::VectorXd& theta, bool with_gradient) const override;
    /// On all cores.
    std::vector<double> objectives(const std::vector<Eigen::VectorXd>& thetas) const override;
    Fit fit(const Eigen::VectorXd& theta) const;
    /// Covariance [n, n] (mm^2 times the square of the units of `functionals`) of functionals^T u_d
    /// at theta, all data seen; functionals [driven_dofs, n].
    Eigen::MatrixXd motion_covariance(const Eigen::VectorXd& theta,
                                      const Eigen::MatrixXd& functionals) const;
    /// Central differences of the gradient, symmetrised.
    Eigen::MatrixXd hessian(const Eigen::VectorXd& theta) const override;
    /// D^T C^-1 D with D = d(J c)/dtheta at the most probable wall motion c.
    Eigen::MatrixXd seen_information(const Eigen::VectorXd& theta) const override;

    // For several problems together (JointProblem), in the modes of the rows:
    const ObservedRows& observed_rows() const { return observed_; }
    /// [X | s] with J P = -G_o V X and y - e = -G_o V s [modes, rank + 1].
    Eigen::MatrixXd shapes(const Eigen::VectorXd& theta) const;
    /// The change of X w + s with ln E, the free motion w [rank] held [modes, num unknown].
    Eigen::MatrixXd change_of_shape(const Eigen::VectorXd& theta,
                                    const Eigen::VectorXd& motion) const;

    /// Of the free wall motion: how many combinations of functionals the walls leave open, and the
    /// six motions of a frame that is unknown.
    Index rank() const { return static_cast<Index>(spread_root_.cols()); }
    Index num_observed_rows() const { return static_cast<Index>(observed_.rows.size()); }
    double noise_log_determinant() const { return noise_log_determinant_; }  ///< ln det R
    const std::vector<Unknown>& unknowns() const override { return unknowns_; }

private:
    struct Response;
    void read_rows(const std::vector<LinearRow>& rows, const Eigen::VectorXd& observed);
    Eigen::MatrixXd spread_of_motions() const;
    bool is_stable(const Eigen::VectorXd& theta) const;
    Response respond(const Eigen::VectorXd& theta) const;
    Eigen::MatrixXd change_of_shape(const Response& response, const Eigen::VectorXd& motion) const;
    void add_gradient(const Response& response, Eigen::VectorXd& gradient) const;

    const ResponseModel& model_;
    const WallPrior& prior_;
    FramePrior frame_;
    WallPosterior walls_;
    std::vector<Unknown> unknowns_;
    std::vector<Index> unknown_;  ///< regions of `unknowns_`
    ObservedRows observed_;
    // Their products, weighted by R^-1: no evaluation touches the rows.
    // V has the modes of the model and then, if the frame is unknown, its six motions.
    Eigen::MatrixXd information_;       ///< V^T G_o^T R^-1 G_o V [modes, modes]
    Eigen::VectorXd pull_of_target_;    ///< V^T G_o^T R^-1 y [modes]
    double target_misfit_ = 0;          ///< y^T R^-1 y
    double noise_log_determinant_ = 0;  ///< ln det R
    double noise_trace_ = 0;            ///< tr D R, D the weights of the rows
    Eigen::VectorXd mean_;              ///< N m, or N (m - u_d*)
    Eigen::MatrixXd spread_root_;       ///< P [functionals, rank], P P^T = N H^-1 N^T
    /// What of the frame's motion belongs to the columns of [P | N m], [6 or 0, rank + 1]: -L, and
    /// minus its mean (modes count backwards: J c = -G_o V x).
    Eigen::MatrixXd frame_shapes_;
    std::vector<Eigen::MatrixXd>
        coupling_;  ///< [T_r P | T_r N m + g_r] per region; empty without driven nodes and g
};

}  // namespace palpate
