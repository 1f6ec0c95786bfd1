// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "host/inverse/reduced_model.hpp"

namespace palpate {

/// Gaussian prior of ln E of one unknown region.
struct ModulusPrior {
    Index region = 0;
    double mean_ln = 0;
    double sd_ln = 1;
};

/// One surface distance, linearised: residual + normal . (u - u_linearised), with noise sigma.
struct LinearRow {
    bool on_driven = false;
    Index position = 0;  ///< of its node among the driven or the observed nodes
    Vec3 normal = Vec3::Zero();
    double residual_mm = 0;
    double sigma_mm = 1;
};

/// The inverse problem with the surface distances linearised at one driven displacement, and the
/// driven displacement integrated out.
///
/// With u_d ~ N(m, H^-1) (prior and driven observations; independent of the moduli) and
/// y = -G_o S_oo^-1 S_od u_d + noise, the observed rows give for theta = ln E
///   F(theta) = 1/2 e^T C^-1 e + 1/2 ln det C + 1/2 |(theta - theta_0)/sd|^2,
///   e = y - J m,   C = R + J H^-1 J^T,   J = -B^T S_od,   B = S_oo^-1 G_o^T
/// (Gaussian process regression; Rasmussen and Williams 2006, eq. 2.30). The determinant is what a
/// joint minimum over (u_d, theta) lacks: without it soft tissue, which can follow any noise, is
/// always preferred and the modulus comes out too low.
class LinearisedProblem {
public:
    /// `driven` [driven_dofs] and `observed` [observed_dofs]: the displacement at which `rows` are
    /// linearised. `precision`: prior precision of the driven displacement.
    LinearisedProblem(const ReducedModel& model, const std::vector<LinearRow>& rows,
                      const Eigen::VectorXd& driven, const Eigen::VectorXd& observed,
                      const Eigen::SparseMatrix<double>& precision,
                      std::vector<ModulusPrior> priors);

    struct Evaluation {
        double objective = 0;        ///< F
        double log_determinant = 0;  ///< ln det C, part of F
        Eigen::VectorXd gradient;    ///< dF/dtheta [num unknown], empty if not asked for
        Eigen::VectorXd driven;      ///< most probable u_d at theta [driven_dofs]
        double weighted_misfit = 0;  ///< r^T R^-1 r of the observed residual r = R C^-1 e there
        double effective_rows = 0;   ///< trace of R C^-1: rows that the fit does not use up
    };

    /// theta: ln E of the unknown regions, in the order of the priors.
    Evaluation evaluate(const Eigen::VectorXd& theta, bool with_gradient) const;
    /// Central differences of the gradient [num unknown, num unknown], symmetrised.
    Eigen::MatrixXd hessian(const Eigen::VectorXd& theta) const;

    Index num_unknown() const { return static_cast<Index>(priors_.size()); }
    Index num_observed_rows() const { return static_cast<Index>(target_.size()); }
    const std::vector<ModulusPrior>& priors() const { return priors_; }
    const Eigen::VectorXd& driven_mean() const { return mean_; }

private:
    struct Response;
    Response respond(const Eigen::VectorXd& theta) const;
    void add_gradient(const Response& response, const Eigen::VectorXd& alpha,
                      const Eigen::MatrixXd& inverse_covariance, Eigen::VectorXd& gradient) const;
    Eigen::MatrixXd whitened(const CondensedRegion& region) const;
    void precompute_covariance(const Eigen::MatrixXd& driven_hessian);

    ReducedModel model_;
    std::vector<ModulusPrior> priors_;
    Eigen::MatrixXd normals_;   ///< G_o^T [observed_dofs, rows]
    Eigen::VectorXd target_;    ///< y
    Eigen::VectorXd variance_;  ///< diagonal of R
    Eigen::VectorXd mean_;      ///< m
    Eigen::MatrixXd factor_;    ///< lower Cholesky factor of H, observed rows present
    std::vector<Eigen::VectorXd> mean_coupling_;            ///< S_r,od m, per region
    std::vector<std::vector<Eigen::MatrixXd>> covariance_;  ///< S_r,od H^-1 S_s,od^T per pair
    std::vector<Eigen::MatrixXd> whitened_coupling_;        ///< L^-1 S_r,od^T per region
};

}  // namespace palpate
