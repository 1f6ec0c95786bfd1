// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/tangent_solve.hpp"

#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {

TangentSolve::TangentSolve(const SolidAssembly& solid, const std::string& library)
    : solid_(solid),
      contact_(solid.model()),
      matrix_(solid.make_matrix()),
      free_(number_free_dofs(matrix_.graph, solid.model().prescribed)),
      factor_(make_sparse_factor(library)) {}

void TangentSolve::fill_matrix(const Eigen::VectorXd& u) {
    solid_.tangent(u, matrix_);
    contact_.add_tangent(u, matrix_);
}

bool TangentSolve::factorise(const Eigen::VectorXd& u, double shift) {
    fill_matrix(u);
    if (free_.count == 0) return true;
    SparseFactor::Lower lower = free_lower(matrix_, free_);
    if (shift > 0) {
        const double size = lower.diagonal().cwiseAbs().mean();
        for (Index k = 0; k < free_.count; ++k) lower.coeffRef(k, k) += shift * size;
    }
    if (!is_analysed_) factor_->analyse(lower);
    is_analysed_ = true;
    is_factorised_ = false;
    try {
        factor_->factorise(lower);
        is_factorised_ = true;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        failure_ = error.what();
        return false;
    }
    return true;
}

void TangentSolve::solve(const Eigen::VectorXd& r, Eigen::VectorXd& x) const {
    if (free_.count == 0) return;
    for (Eigen::Index d = 0; d < x.size(); ++d)
        if (free_.number[d] >= 0) x[d] = 0;
    Eigen::VectorXd right = r;
    if (!x.isZero(0)) right -= times(x);
    FactorBlock block(free_.count, factor_->block_width(1));
    const std::vector<int>& position = factor_->position();
    for (Eigen::Index d = 0; d < r.size(); ++d)
        if (free_.number[d] >= 0) *block.row(position[free_.number[d]]) = right[d];
    factor_->solve(block);
    for (Eigen::Index d = 0; d < r.size(); ++d)
        if (free_.number[d] >= 0) x[d] = *block.row(position[free_.number[d]]);
}

Eigen::VectorXd TangentSolve::times(const Eigen::VectorXd& x) const {
    using Block = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
    Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
    const Adjacency& graph = matrix_.graph;
    for (Index n = 0; n < matrix_.num_rows(); ++n)
        for (Index k = graph.offsets[n]; k < graph.offsets[n + 1]; ++k)
            y.segment<3>(3 * n) += Block(matrix_.block(k)) * x.segment<3>(3 * graph.items[k]);
    return y;
}

/// Iterative refinement with a factor that may be another tangent's, or one with the limits of
/// friction held: then it goes as slowly as those were found. False if it does not get there.
bool TangentSolve::refine(const Eigen::VectorXd& r, Eigen::VectorXd& x) const {
    constexpr double tolerance = 1e-12;
    const double slowest = contact_.has_friction() ? 0.99 : 0.5;
    const int most_steps = contact_.has_friction() ? 500 : 20;
    Eigen::VectorXd left = r;
    for (Eigen::Index d = 0; d < r.size(); ++d)
        if (free_.number[d] < 0) left[d] = 0;
    const Eigen::VectorXd right = left;
    double before = left.norm();
    x.setZero(r.size());
    for (int step = 0; step < most_steps && left.norm() > tolerance * right.norm(); ++step) {
        Eigen::VectorXd change = Eigen::VectorXd::Zero(r.size());
        solve(left, change);
        x += change;
        left = right - times(x);
        for (Eigen::Index d = 0; d < r.size(); ++d)
            if (free_.number[d] < 0) left[d] = 0;
        if (!(left.norm() <= slowest * before)) break;
        before = left.norm();
    }
    return left.norm() <= 1e3 * tolerance * right.norm();
}

bool TangentSolve::solve_at(const Eigen::VectorXd& u, const Eigen::VectorXd& r,
                            Eigen::VectorXd& x) {
    if (is_factorised_ && !contact_.has_friction()) {
        fill_matrix(u);
        if (refine(r, x)) return true;
    }
    if (!factorise(u)) return false;
    contact_.add_limit_rates(u, matrix_);
    return refine(r, x);
}

double TangentSolve::force_of_rounding(const Eigen::VectorXd& u) const {
    double sum = 0;
    const Adjacency& graph = matrix_.graph;
    for (Index n = 0; n < matrix_.num_rows(); ++n)
        for (Index k = graph.offsets[n]; k < graph.offsets[n + 1]; ++k) {
            if (graph.items[k] != n) continue;
            for (int i = 0; i < 3; ++i) sum += std::pow(matrix_.block(k)[4 * i] * u[3 * n + i], 2);
        }
    return 1e-14 * std::sqrt(sum);
}

}  // namespace palpate
