// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/block_covariance.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace palpate {
namespace {

/// The value in the middle.
double median_of(Eigen::VectorXd values) {
    const auto middle = values.begin() + values.size() / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

BlockCovariance::BlockCovariance(const Eigen::VectorXd& variance, double amplitude,
                                 std::shared_ptr<const DiscrepancyBasis> basis)
    : basis_(amplitude > 0 ? std::move(basis) : nullptr),
      amplitude_(amplitude),
      variance_(variance),
      white_(variance) {
    if (basis_) white_ += amplitude_ * amplitude_ * basis_->remainder;
    log_determinant_ = white_.array().log().sum();
    if (!basis_) return;
    inner_.compute(mode_curvature());
    // ln det C = ln det N + ln det(I + s^2 U^T N^-1 U)
    log_determinant_ += 2.0 * inner_.matrixLLT().diagonal().array().log().sum();
}

/// I + s^2 U^T N^-1 U. With orthogonal modes only the rows count in which N is not what it is in
/// most: U^T N^-1 U = U^T U / n + sum over those rows of u u^T (1 / N - 1 / n).
Eigen::MatrixXd BlockCovariance::mode_curvature() const {
    const Eigen::MatrixXd& modes = basis_->modes;
    const double square = amplitude_ * amplitude_;
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Identity(modes.cols(), modes.cols());
    if (modes.cols() == 0) return curvature;
    const double common = median_of(white_);
    std::vector<Index> others;
    for (Index i = 0; i < white_.size(); ++i)
        if (white_[i] != common) others.push_back(i);
    if (!basis_->is_orthogonal || 2 * static_cast<Index>(others.size()) > white_.size()) {
        const Eigen::MatrixXd scaled = white_.cwiseSqrt().cwiseInverse().asDiagonal() * modes;
        curvature.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose(), square);
        return curvature;
    }
    curvature.diagonal() += square / common * modes.colwise().squaredNorm().transpose();
    const Eigen::MatrixXd rows = modes(others, Eigen::all);
    const Eigen::VectorXd more = white_(others).cwiseInverse().array() - 1.0 / common;
    curvature += square * (rows.transpose() * more.asDiagonal() * rows);
    return curvature;
}

Eigen::MatrixXd BlockCovariance::solve(const Eigen::MatrixXd& right) const {
    // C^-1 = N^-1 - s^2 N^-1 U (I + s^2 U^T N^-1 U)^-1 U^T N^-1
    Eigen::MatrixXd solution = white_.cwiseInverse().asDiagonal() * right;
    if (!basis_ || basis_->modes.cols() == 0) return solution;
    const Eigen::MatrixXd inner = inner_.solve(basis_->modes.transpose() * solution);
    solution -=
        white_.cwiseInverse().asDiagonal() * (amplitude_ * amplitude_ * (basis_->modes * inner));
    return solution;
}

Eigen::VectorXd BlockCovariance::independent_part(const Eigen::VectorXd& residual) const {
    return variance_.cwiseProduct(solve(residual).col(0));
}

Eigen::VectorXd BlockCovariance::variances() const {
    if (!basis_) return white_;
    return white_ + amplitude_ * amplitude_ * basis_->modes.rowwise().squaredNorm();
}

}  // namespace palpate
