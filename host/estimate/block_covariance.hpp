// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>

#include "host/estimate/discrepancy.hpp"

namespace palpate {

/// Covariance of one block's residuals, factored: C = diag(v) + s^2 K.
class BlockCovariance {
public:
    /// `variance` v [num_row] of the independent noise, above 0; `basis` of K, or null without a
    /// discrepancy. Cost: num_row * rank^2 operations, or less where v is the same in most rows and
    /// the basis is orthogonal.
    BlockCovariance(const Eigen::VectorXd& variance, double amplitude,
                    std::shared_ptr<const DiscrepancyBasis> basis);

    /// C^-1 times the columns of `right`, [num_row, any].
    Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
    double log_determinant() const { return log_determinant_; }
    /// The independent noise that most probably is in a residual: diag(v) C^-1 r, [num_row].
    Eigen::VectorXd independent_part(const Eigen::VectorXd& residual) const;
    /// The diagonal of C, [num_row].
    Eigen::VectorXd variances() const;

private:
    Eigen::MatrixXd mode_curvature() const;

    std::shared_ptr<const DiscrepancyBasis> basis_;  ///< null: no discrepancy
    double amplitude_ = 0;
    Eigen::VectorXd variance_;
    Eigen::VectorXd white_;              ///< N = v + s^2 g
    Eigen::LLT<Eigen::MatrixXd> inner_;  ///< of I + s^2 U^T N^-1 U
    double log_determinant_ = 0;
};

}  // namespace palpate
