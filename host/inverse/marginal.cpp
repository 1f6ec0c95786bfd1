// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/marginal.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// H = Q + G_d^T R_d^-1 G_d and the right-hand side of its mean.
struct DrivenNormalEquations {
    Sparse hessian;
    Eigen::VectorXd right_hand_side;
};

DrivenNormalEquations driven_equations(const std::vector<LinearRow>& rows,
                                       const Eigen::VectorXd& driven, const Sparse& precision) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(driven.size());
    for (const auto& row : rows) {
        if (!row.on_driven) continue;
        const Vec3& g = row.normal;
        const double weight = 1.0 / (row.sigma_mm * row.sigma_mm);
        const Index first = 3 * row.position;
        for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
                entries.emplace_back(first + a, first + b, weight * g[a] * g[b]);
            }
        }
        right.segment<3>(first) += weight * (g.dot(driven.segment<3>(first)) - row.residual_mm) * g;
    }
    Sparse data(driven.size(), driven.size());
    data.setFromTriplets(entries.begin(), entries.end());
    return {precision + data, right};
}

}  // namespace

struct LinearisedProblem::Response {
    std::vector<double> stiffness_kpa;        // by position in regions()
    Eigen::LLT<Eigen::MatrixXd> equilibrium;  // of S_oo
    Eigen::MatrixXd basis;                    // B [observed_dofs, rows]
    Eigen::MatrixXd coupling_covariance;      // S_od H^-1 S_od^T at these moduli
    Eigen::VectorXd mean_coupling;            // S_od m
};

LinearisedProblem::LinearisedProblem(const ReducedModel& model, const std::vector<LinearRow>& rows,
                                     const Eigen::VectorXd& driven, const Eigen::VectorXd& observed,
                                     const Sparse& precision, std::vector<ModulusPrior> priors)
    : model_(model), priors_(std::move(priors)) {
    const Index count = static_cast<Index>(
        std::count_if(rows.begin(), rows.end(), [](const auto& row) { return !row.on_driven; }));
    normals_ = Eigen::MatrixXd::Zero(model_.observed_dofs(), count);
    target_.resize(count);
    variance_.resize(count);
    Index j = 0;
    for (const auto& row : rows) {
        if (row.on_driven) continue;
        normals_.block<3, 1>(3 * row.position, j) = row.normal;
        target_[j] = row.normal.dot(observed.segment<3>(3 * row.position)) - row.residual_mm;
        variance_[j] = row.sigma_mm * row.sigma_mm;
        ++j;
    }
    const auto equations = driven_equations(rows, driven, precision);
    Eigen::SimplicialLDLT<Sparse> solver(equations.hessian);
    if (solver.info() != Eigen::Success) {
        throw Error(ErrorCode::internal, "the prior of the driven displacement is not definite");
    }
    mean_ = solver.solve(equations.right_hand_side);
    if (count > 0) precompute_covariance(equations.hessian);
}

/// L^-1 S_r,od^T. Only the region's own driven nodes have rows in S_r,od^T, so where they are few
/// it is cheaper to solve for unit columns there.
Eigen::MatrixXd LinearisedProblem::whitened(const CondensedRegion& region) const {
    const auto& coupling = region.observed_driven;
    const bool by_units = coupling.cols() < coupling.rows();
    Eigen::MatrixXd right =
        Eigen::MatrixXd::Zero(model_.driven_dofs(), by_units ? coupling.cols() : coupling.rows());
    for (std::size_t d = 0; d < region.driven.size(); ++d) {
        auto rows = right.middleRows<3>(3 * region.driven[d]);
        if (by_units) {
            rows.middleCols<3>(3 * d).setIdentity();
        } else {
            rows = coupling.middleCols<3>(3 * d).transpose();
        }
    }
    if (right.cols() > 0) factor_.triangularView<Eigen::Lower>().solveInPlace(right);
    if (!by_units) return right;
    return right * coupling.transpose();
}

void LinearisedProblem::precompute_covariance(const Eigen::MatrixXd& driven_hessian) {
    factor_ = cholesky(driven_hessian, "covariance of the driven displacement").matrixL();
    const auto& regions = model_.regions();
    for (const auto& region : regions) {
        whitened_coupling_.push_back(whitened(region));
        mean_coupling_.push_back(model_.unit_coupling_times(region, mean_));
    }
    covariance_.resize(regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        for (std::size_t s = 0; s < regions.size(); ++s) {
            if (regions[r].driven.empty() || regions[s].driven.empty()) {
                covariance_[r].emplace_back();
            } else if (s < r) {
                covariance_[r].push_back(covariance_[s][r].transpose());
            } else {
                covariance_[r].push_back(whitened_coupling_[r].transpose() * whitened_coupling_[s]);
            }
        }
    }
}

LinearisedProblem::Response LinearisedProblem::respond(const Eigen::VectorXd& theta) const {
    ReducedModel model = model_;
    for (Index k = 0; k < num_unknown(); ++k) {
        model.set_stiffness(priors_[k].region, std::exp(theta[k]));
    }
    Response response;
    const auto& regions = model_.regions();
    for (const auto& region : regions) {
        response.stiffness_kpa.push_back(model.stiffness_kpa()[region.region]);
    }
    response.equilibrium = cholesky(model.stiffness(), "stiffness of the observed nodes");
    response.basis = response.equilibrium.solve(normals_);
    response.mean_coupling = Eigen::VectorXd::Zero(model_.observed_dofs());
    response.coupling_covariance =
        Eigen::MatrixXd::Zero(model_.observed_dofs(), model_.observed_dofs());
    for (std::size_t r = 0; r < regions.size(); ++r) {
        response.mean_coupling += response.stiffness_kpa[r] * mean_coupling_[r];
        for (std::size_t s = 0; s < regions.size(); ++s) {
            if (covariance_[r][s].size() == 0) continue;
            const double scale = response.stiffness_kpa[r] * response.stiffness_kpa[s];
            for (std::size_t b = 0; b < regions[s].observed.size(); ++b) {
                for (std::size_t a = 0; a < regions[r].observed.size(); ++a) {
                    response.coupling_covariance.block<3, 3>(3 * regions[r].observed[a],
                                                             3 * regions[s].observed[b]) +=
                        scale * covariance_[r][s].block<3, 3>(3 * a, 3 * b);
                }
            }
        }
    }
    return response;
}

LinearisedProblem::Evaluation LinearisedProblem::evaluate(const Eigen::VectorXd& theta,
                                                          bool with_gradient) const {
    Evaluation result;
    result.gradient = Eigen::VectorXd::Zero(num_unknown());
    result.driven = mean_;
    for (Index k = 0; k < num_unknown(); ++k) {
        const double z = (theta[k] - priors_[k].mean_ln) / priors_[k].sd_ln;
        result.objective += 0.5 * z * z;
        result.gradient[k] = z / priors_[k].sd_ln;
    }
    if (num_observed_rows() == 0) return result;

    const Response response = respond(theta);
    const Eigen::VectorXd error = target_ + response.basis.transpose() * response.mean_coupling;
    Eigen::MatrixXd covariance =
        response.basis.transpose() * (response.coupling_covariance * response.basis);
    covariance.diagonal() += variance_;
    const auto factor = cholesky(covariance, "covariance of the observed surface");
    const Eigen::VectorXd alpha = factor.solve(error);
    const Eigen::MatrixXd inverse =
        factor.solve(Eigen::MatrixXd::Identity(error.size(), error.size()));
    result.log_determinant = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
    result.objective += 0.5 * error.dot(alpha) + 0.5 * result.log_determinant;
    result.weighted_misfit = alpha.dot(variance_.cwiseProduct(alpha));
    result.effective_rows = variance_.dot(inverse.diagonal());

    // u_d = m + H^-1 J^T alpha with J^T = -S_od^T B, H^-1 = L^-T L^-1.
    const Eigen::VectorXd basis_alpha = response.basis * alpha;
    Eigen::VectorXd shift = Eigen::VectorXd::Zero(model_.driven_dofs());
    for (std::size_t r = 0; r < model_.regions().size(); ++r) {
        const auto& nodes = model_.regions()[r].observed;
        Eigen::VectorXd local(3 * nodes.size());
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            local.segment<3>(3 * k) = basis_alpha.segment<3>(3 * nodes[k]);
        }
        shift -= response.stiffness_kpa[r] * (whitened_coupling_[r] * local);
    }
    factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(shift);
    result.driven += shift;
    if (with_gradient) add_gradient(response, alpha, inverse, result.gradient);
    return result;
}

// With dB = -S_oo^-1 S'_r B and M = C^-1 - alpha alpha^T:
//   dF = alpha . de + 1/2 tr(M dC),  de = dB^T q + B^T q_r',  dC = 2 sym(dB^T K B) + B^T dK B.
void LinearisedProblem::add_gradient(const Response& response, const Eigen::VectorXd& alpha,
                                     const Eigen::MatrixXd& inverse_covariance,
                                     Eigen::VectorXd& gradient) const {
    const auto& regions = model_.regions();
    const Eigen::MatrixXd weight = inverse_covariance - alpha * alpha.transpose();
    const Eigen::MatrixXd weighted_basis = response.basis * weight;  // B M
    const Eigen::MatrixXd covariance_basis =
        response.coupling_covariance * weighted_basis;  // K B M
    const Eigen::VectorXd basis_alpha = response.basis * alpha;
    const Eigen::MatrixXd adjoint = response.equilibrium.solve(covariance_basis);
    const Eigen::VectorXd adjoint_mean = response.equilibrium.solve(response.mean_coupling);
    for (Index k = 0; k < num_unknown(); ++k) {
        for (std::size_t r = 0; r < regions.size(); ++r) {
            if (regions[r].region != priors_[k].region) continue;
            const double modulus = response.stiffness_kpa[r];
            Eigen::MatrixXd derivative =
                Eigen::MatrixXd::Zero(response.basis.rows(), response.basis.cols());
            model_.add_observed_product(regions[r], modulus, response.basis, derivative);
            gradient[k] -= (adjoint.array() * derivative.array()).sum();
            gradient[k] -= adjoint_mean.dot(derivative * alpha);
            gradient[k] += modulus * basis_alpha.dot(mean_coupling_[r]);
            Eigen::MatrixXd changed =
                Eigen::MatrixXd::Zero(response.basis.rows(), response.basis.cols());
            for (std::size_t s = 0; s < regions.size(); ++s) {
                if (covariance_[r][s].size() == 0) continue;
                const double scale = modulus * response.stiffness_kpa[s];
                Eigen::MatrixXd local(3 * regions[s].observed.size(), weighted_basis.cols());
                for (std::size_t b = 0; b < regions[s].observed.size(); ++b) {
                    local.middleRows<3>(3 * b) =
                        weighted_basis.middleRows<3>(3 * regions[s].observed[b]);
                }
                const Eigen::MatrixXd product = scale * (covariance_[r][s] * local);
                for (std::size_t a = 0; a < regions[r].observed.size(); ++a) {
                    changed.middleRows<3>(3 * regions[r].observed[a]) +=
                        product.middleRows<3>(3 * a);
                }
            }
            gradient[k] += (response.basis.array() * changed.array()).sum();
        }
    }
}

Eigen::MatrixXd LinearisedProblem::hessian(const Eigen::VectorXd& theta) const {
    constexpr double step = 1e-3;  // of ln E: 0.1 %, far above the rounding of the gradient
    const Index n = num_unknown();
    Eigen::MatrixXd hessian(n, n);
    for (Index k = 0; k < n; ++k) {
        Eigen::VectorXd shift = Eigen::VectorXd::Zero(n);
        shift[k] = step;
        hessian.col(k) =
            (evaluate(theta + shift, true).gradient - evaluate(theta - shift, true).gradient) /
            (2.0 * step);
    }
    return 0.5 * (hessian + hessian.transpose());
}

}  // namespace palpate
