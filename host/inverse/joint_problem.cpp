// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/joint_problem.hpp"

#include <Eigen/Cholesky>
#include <utility>

#include "host/inverse/reduced_model.hpp"
#include "solver/base/parallel.hpp"
#include "solver/base/serial_blas.hpp"

namespace palpate {
namespace {

constexpr double share_of_reference = 0.5;

/// Covariance (mm^2) of two targets' rows.
double shared_noise(const LinearRow& a, const LinearRow& b) {
    if (a.surface != b.surface) return 0;
    return share_of_reference * a.contour_mm * b.contour_mm *
           contour_correlation((a.place - b.place).norm());
}

}  // namespace

// As LinearisedProblem's, of all targets: [X | s] block by block.
struct JointProblem::Response {
    Eigen::MatrixXd free;               ///< X [modes, ranks]
    Eigen::VectorXd mean;               ///< s [modes]
    Eigen::MatrixXd informed;           ///< I X
    Eigen::LLT<Eigen::MatrixXd> inner;  ///< of M = 1 + X^T I X
    Eigen::VectorXd motion;             ///< w = M^-1 B^T e
    double misfit = 0;                  ///< e^T C^-1 e
};

JointProblem::JointProblem(std::vector<std::shared_ptr<const LinearisedProblem>> targets)
    : targets_(std::move(targets)), first_mode_{0} {
    std::vector<Index> first_row{0};
    for (const auto& target : targets_) {
        const ObservedRows& seen = target->observed_rows();
        first_row.push_back(first_row.back() + seen.along_modes.rows());
        first_mode_.push_back(first_mode_.back() + seen.along_modes.cols());
    }
    const Index num_rows = first_row.back(), num_modes = first_mode_.back();
    Eigen::MatrixXd noise(num_rows, num_rows);
    Eigen::MatrixXd seen_modes = Eigen::MatrixXd::Zero(num_rows, num_modes);
    Eigen::VectorXd wanted(num_rows);
    for (std::size_t a = 0; a < targets_.size(); ++a) {
        const ObservedRows& seen = targets_[a]->observed_rows();
        const Index n = seen.along_modes.rows();
        seen_modes.block(first_row[a], first_mode_[a], n, seen.along_modes.cols()) =
            seen.along_modes;
        wanted.segment(first_row[a], n) = seen.target;
        for (Index j = 0; j < n; ++j) {
            for (Index i = j; i < n; ++i)
                noise(first_row[a] + i, first_row[a] + j) =
                    i == j ? noise_variance(seen.rows[j])
                           : noise_covariance(seen.rows[i], seen.rows[j]);
            for (std::size_t b = a + 1; b < targets_.size(); ++b) {
                const std::vector<LinearRow>& others = targets_[b]->observed_rows().rows;
                for (std::size_t i = 0; i < others.size(); ++i)
                    noise(first_row[b] + Index(i), first_row[a] + j) =
                        shared_noise(others[i], seen.rows[j]);
            }
        }
    }
    information_.setZero(num_modes, num_modes);
    pull_of_target_.setZero(num_modes);
    if (num_rows == 0) return;
    const auto factor = cholesky(noise, "covariance of the noise of all targets");
    factor.matrixL().solveInPlace(seen_modes);
    factor.matrixL().solveInPlace(wanted);
    noise_log_determinant_ = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
    target_misfit_ = wanted.squaredNorm();
    information_.selfadjointView<Eigen::Lower>().rankUpdate(seen_modes.transpose());
    information_.triangularView<Eigen::StrictlyUpper>() = information_.transpose();
    pull_of_target_ = seen_modes.transpose() * wanted;
}

JointProblem::Response JointProblem::respond(const Eigen::VectorXd& theta) const {
    Index rank = 0;
    for (const auto& target : targets_) rank += target->rank();
    Response response;
    response.free.setZero(information_.rows(), rank);
    response.mean.resize(information_.rows());
    Index column = 0;
    for (std::size_t a = 0; a < targets_.size(); ++a) {
        const Eigen::MatrixXd shapes = targets_[a]->shapes(theta);
        const Index own = targets_[a]->rank();
        response.free.block(first_mode_[a], column, shapes.rows(), own) = shapes.leftCols(own);
        response.mean.segment(first_mode_[a], shapes.rows()) = shapes.col(own);
        column += own;
    }
    response.informed = information_ * response.free;
    Eigen::MatrixXd inner = response.free.transpose() * response.informed;
    inner.diagonal().array() += 1.0;
    response.inner = cholesky(inner, "covariance of the observed surfaces of all targets");
    const Eigen::VectorXd informed_mean = information_ * response.mean;
    const Eigen::VectorXd seen_error =
        -(response.free.transpose() * (pull_of_target_ + informed_mean));
    response.motion = response.inner.solve(seen_error);
    response.misfit = target_misfit_ + response.mean.dot(2.0 * pull_of_target_ + informed_mean) -
                      response.motion.dot(seen_error);
    return response;
}

double JointProblem::value(const Eigen::VectorXd& theta) const {
    const Response response = respond(theta);
    return prior_energy(priors(), theta) + 0.5 * (response.misfit + noise_log_determinant_) +
           response.inner.matrixLLT().diagonal().array().log().sum();
}

JointProblem::Evaluation JointProblem::evaluate(const Eigen::VectorXd& theta,
                                                bool with_gradient) const {
    constexpr double step = 1e-3;  // of ln E
    const Index n = num_unknown();
    std::vector<Eigen::VectorXd> points{theta};
    for (Index k = 0; with_gradient && k < n; ++k) {
        points.push_back(theta + step * Eigen::VectorXd::Unit(n, k));
        points.push_back(theta - step * Eigen::VectorXd::Unit(n, k));
    }
    const std::vector<double> values = objectives(points);
    Evaluation result;
    result.objective = values[0];
    result.gradient = Eigen::VectorXd::Zero(n);
    for (Index k = 0; with_gradient && k < n; ++k)
        result.gradient[k] = (values[1 + 2 * k] - values[2 + 2 * k]) / (2.0 * step);
    return result;
}

std::vector<double> JointProblem::objectives(const std::vector<Eigen::VectorXd>& thetas) const {
    std::vector<double> values(thetas.size());
    const SerialBlas serial;
    parallel_ranges(static_cast<Index>(thetas.size()), 1, [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k) values[k] = value(thetas[k]);
    });
    return values;
}

JointProblem::Fit JointProblem::fit(const Eigen::VectorXd&) const { return {}; }

Eigen::MatrixXd JointProblem::hessian(const Eigen::VectorXd& theta) const {
    constexpr double stride = 0.05;  // of ln E: second differences of F itself
    const Index n = num_unknown();
    std::vector<Eigen::VectorXd> points{theta};
    for (Index a = 0; a < n; ++a)
        for (Index b = 0; b <= a; ++b)
            for (const double sign : {1.0, -1.0})
                points.push_back(theta + sign * stride *
                                             (Eigen::VectorXd::Unit(n, a) +
                                              (a == b ? Eigen::VectorXd::Zero(n).eval()
                                                      : Eigen::VectorXd::Unit(n, b).eval())));
    const std::vector<double> values = objectives(points);
    // d^T H d along each direction d, then H_ab from those of a, b and a + b.
    Eigen::MatrixXd along(n, n);
    std::size_t next = 1;
    for (Index a = 0; a < n; ++a)
        for (Index b = 0; b <= a; ++b, next += 2)
            along(a, b) = (values[next] + values[next + 1] - 2.0 * values[0]) / (stride * stride);
    Eigen::MatrixXd hessian(n, n);
    for (Index a = 0; a < n; ++a)
        for (Index b = 0; b <= a; ++b)
            hessian(a, b) = hessian(b, a) =
                a == b ? along(a, a) : 0.5 * (along(a, b) - along(a, a) - along(b, b));
    return hessian;
}

double JointProblem::share_of_one(const Eigen::VectorXd& theta) const {
    double one = 0;
    for (const auto& target : targets_)
        one += target->seen_information(theta).trace() / double(targets_.size());
    const double all = seen_information(theta).trace();
    return one < all ? one / all : 1.0;
}

Eigen::MatrixXd JointProblem::seen_information(const Eigen::VectorXd& theta) const {
    const Response response = respond(theta);
    Eigen::MatrixXd change(information_.rows(), num_unknown());
    Index column = 0;
    for (std::size_t a = 0; a < targets_.size(); ++a) {
        const Index own = targets_[a]->rank();
        change.middleRows(first_mode_[a], first_mode_[a + 1] - first_mode_[a]) =
            targets_[a]->change_of_shape(theta, response.motion.segment(column, own));
        column += own;
    }
    const Eigen::MatrixXd unseen = response.informed.transpose() * change;
    return change.transpose() * information_ * change -
           unseen.transpose() * response.inner.solve(unseen);
}

}  // namespace palpate
