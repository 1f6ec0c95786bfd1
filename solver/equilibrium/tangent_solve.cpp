// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/tangent_solve.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "solver/base/parallel.hpp"
#include "solver/model/block_product.hpp"

namespace palpate {
namespace {

/// Degrees of freedom of open edges up to which their part is an update of the factor.
constexpr std::size_t most_update_rows = 48;
/// Free dofs up to which all columns go through the factor as one block.
constexpr Index most_block_dofs = 5000;

}  // namespace

TangentSolve::TangentSolve(const SolidAssembly& solid, const MatrixSolverOptions& options)
    : solid_(solid),
      contact_(solid.model()),
      pressure_(solid.model()),
      matrix_(solid.make_matrix()),
      free_(number_free_dofs(matrix_.graph, solid.model().prescribed)),
      solver_(make_matrix_solver(
          {solid.model().mesh.nodes, solid.model().prescribed, matrix_.graph}, options)) {}

void TangentSolve::fill_matrix(const Eigen::VectorXd& u) {
    solid_.tangent(u, matrix_);
    contact_.add_tangent(u, matrix_);
    pressure_.add_symmetric(u, matrix_);
}

bool TangentSolve::factorise(const Eigen::VectorXd& u, double shift) {
    fill_matrix(u);
    is_factorised_ = solver_->set(matrix_, shift);
    // A shifted tangent is for a way down, not for a place: its symmetric half will do.
    is_unsymmetric_ = !pressure_.is_empty() && shift == 0;
    is_updated_ = false;
    if (!is_unsymmetric_) return is_factorised_;
    if (is_factorised_ && solver_->is_direct()) find_update(u);
    pressure_.add_antisymmetric(u, false, matrix_);
    return is_factorised_;
}

/// Of the factor of the symmetric half, from which `matrix_` has its size.
void TangentSolve::find_update(const Eigen::VectorXd& u) {
    constexpr double rounding = 1e-14;  // of the largest entry of the tangent
    double largest = 0;
    for (const double entry : matrix_.blocks) largest = std::max(largest, std::abs(entry));
    std::map<Index, Eigen::Index> place;
    std::vector<MatrixEntry> entries;
    for (const MatrixEntry& entry : pressure_.antisymmetric_entries(u, rounding * largest))
        if (free_.number[entry.row] >= 0 && free_.number[entry.column] >= 0) {
            place.try_emplace(entry.row, 0);
            place.try_emplace(entry.column, 0);
            entries.push_back(entry);
        }
    if (place.size() > most_update_rows) return;
    is_updated_ = true;
    update_ = {};
    if (place.empty()) return;
    std::vector<Index> rows;
    for (auto& [row, at] : place) {
        at = static_cast<Eigen::Index>(rows.size());
        rows.push_back(row);
    }
    const auto count = static_cast<Eigen::Index>(rows.size());
    Eigen::MatrixXd n = Eigen::MatrixXd::Zero(count, count);
    for (const MatrixEntry& entry : entries)
        n(place[entry.row], place[entry.column]) += entry.value;
    const auto dofs = static_cast<Eigen::Index>(free_.number.size());
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(dofs, count), solved = unit;
    for (Eigen::Index k = 0; k < count; ++k) unit(rows[static_cast<std::size_t>(k)], k) = 1;
    is_updated_ = solver_->solve(unit, solved);
    if (is_updated_) update_ = LowRankUpdate(std::move(rows), n, std::move(solved));
}

/// With the last factor and what was left out of it.
bool TangentSolve::solve_with_factor(const Eigen::MatrixXd& r, bool is_transposed,
                                     Eigen::Ref<Eigen::MatrixXd> x) const {
    if (!solver_->solve(r, x)) return false;
    if (is_updated_) update_.apply(is_transposed, x);
    return true;
}

bool TangentSolve::solve(const Eigen::VectorXd& r, Eigen::VectorXd& x) const {
    for (Eigen::Index d = 0; d < x.size(); ++d)
        if (free_.number[d] >= 0) x[d] = 0;
    Eigen::VectorXd right = r;
    // K_ff x_f = r_f - K_fp x_p
    if (!x.isZero(0)) right -= times(x);
    if (!is_unsymmetric_) return solver_->solve(right, x);
    keep_free(right);
    Eigen::VectorXd change = Eigen::VectorXd::Zero(x.size());
    if (is_updated_) {
        if (!solve_with_factor(right, false, change)) return false;
        x += change;
        return true;
    }
    // Newton's method squares the error: 1e-8 of it is nothing yet.
    if (!solve_unsymmetric(right, {.relative_tolerance = 1e-8}, 1e-4, change)) return false;
    x += change;
    return true;
}

Eigen::MatrixXd TangentSolve::times(const Eigen::MatrixXd& x) const {
    return palpate::times(matrix_, x);
}

void TangentSolve::keep_free(Eigen::Ref<Eigen::MatrixXd> columns) const {
    for (Eigen::Index d = 0; d < columns.rows(); ++d)
        if (free_.number[d] < 0) columns.row(d).setZero();
}

/// x_f = K_ff^-1 r_f by GMRES, with the factor of some symmetric tangent as preconditioner. False
/// if the relative residual stays above `tolerance`.
bool TangentSolve::solve_unsymmetric(const Eigen::VectorXd& r, const GmresOptions& options,
                                     double tolerance, Eigen::VectorXd& x) const {
    const VectorMap product = [&](const Eigen::VectorXd& from, Eigen::VectorXd& to) {
        Eigen::MatrixXd columns = times(from);
        keep_free(columns);
        to = columns.col(0);
        return true;
    };
    const VectorMap precondition = [&](const Eigen::VectorXd& from, Eigen::VectorXd& to) {
        return solver_->solve(from, to);
    };
    if (free_.count == 0) return true;
    return flexible_gmres(product, precondition, r, options, x).relative_residual <= tolerance;
}

/// Iterative refinement with a factor that may be another tangent's, or one with the limits of
/// friction held: then it goes as slowly as those were found. False if it does not get there.
bool TangentSolve::refine(const Eigen::MatrixXd& r, double tolerance, bool is_transposed,
                          Eigen::Ref<Eigen::MatrixXd> x) const {
    constexpr double good_enough = 1e-9;
    const double slowest = contact_.has_friction() ? 0.99 : 0.5;
    const int most_steps = contact_.has_friction() ? 500 : 20;
    Eigen::MatrixXd left = r;
    keep_free(left);
    if (!pressure_.is_empty() && !is_updated_) {
        for (Eigen::Index c = 0; c < left.cols(); ++c) {
            Eigen::VectorXd column = Eigen::VectorXd::Zero(left.rows());
            if (!solve_unsymmetric(left.col(c), {.relative_tolerance = tolerance},
                                   std::max(tolerance, good_enough), column))
                return false;
            x.col(c) = column;
        }
        return true;
    }
    const Eigen::RowVectorXd right = left.colwise().norm();
    const auto worst = [&] {
        double part = 0;
        for (Eigen::Index c = 0; c < left.cols(); ++c)
            if (right[c] > 0) part = std::max(part, left.col(c).norm() / right[c]);
        return part;
    };
    x.setZero();
    if (free_.count == 0) return true;
    double before = worst();
    for (int step = 0; step < most_steps && before > tolerance; ++step) {
        Eigen::MatrixXd change = Eigen::MatrixXd::Zero(r.rows(), r.cols());
        if (!solve_with_factor(left, is_transposed, change)) return false;
        x += change;
        // x += K_old^-1 (r - K x): converges as |1 - K_old^-1 K|^n
        left = r - times(x);
        keep_free(left);
        const double now = worst();
        if (!(now <= slowest * before)) break;
        before = now;
    }
    return worst() <= std::max(tolerance, good_enough);
}

bool TangentSolve::refine_columns(const Eigen::MatrixXd& r, double tolerance, bool is_transposed,
                                  Eigen::MatrixXd& x) const {
    x.resize(r.rows(), r.cols());
    if (solver_->is_direct() && free_.count <= most_block_dofs)
        return refine(r, tolerance, is_transposed, x);
    std::atomic<bool> is_solved{true};
    parallel_ranges(static_cast<Index>(r.cols()), 1, [&](Index begin, Index end) {
        const Index count = end - begin;
        if (!refine(r.middleCols(begin, count), tolerance, is_transposed,
                    x.middleCols(begin, count)))
            is_solved = false;
    });
    return is_solved;
}

bool TangentSolve::solve_at(const Eigen::VectorXd& u, const Eigen::VectorXd& r,
                            Eigen::VectorXd& x) {
    Eigen::MatrixXd columns;
    if (!solve_columns_at(u, r, columns)) return false;
    x = columns.col(0);
    return true;
}

template <class Work>
bool TangentSolve::with_tangent_at(const Eigen::VectorXd& u, bool is_transposed, const Work& work) {
    // The last factor of the search is nearly this tangent's: refining is cheaper than a new one.
    if (is_factorised_ && !contact_.has_friction()) {
        fill_matrix(u);
        pressure_.add_antisymmetric(u, is_transposed, matrix_);
        if (work()) return true;
    }
    if (!factorise(u)) return false;
    // The factor has limits held (symmetric), the product not: refinement finds the difference.
    if (is_unsymmetric_ && is_transposed) {
        fill_matrix(u);
        pressure_.add_antisymmetric(u, true, matrix_);
    }
    contact_.add_limit_rates(u, is_transposed, matrix_);
    return work();
}

bool TangentSolve::solve_columns_at(const Eigen::VectorXd& u, const Eigen::MatrixXd& r,
                                    Eigen::MatrixXd& x, bool is_transposed, double tolerance) {
    return with_tangent_at(u, is_transposed,
                           [&] { return refine_columns(r, tolerance, is_transposed, x); });
}

bool TangentSolve::solve_changes_at(const Eigen::VectorXd& u, const Eigen::MatrixXd& r,
                                    Eigen::MatrixXd& x) {
    constexpr double tolerance = 1e-12;
    Eigen::MatrixXd moved = x;
    for (Eigen::Index d = 0; d < moved.rows(); ++d)
        if (free_.number[d] >= 0) moved.row(d).setZero();
    return with_tangent_at(u, false, [&] {
        // K_ff x_f = r_f - K_fp x_p
        if (!refine_columns(moved.isZero(0) ? r : r - times(moved), tolerance, false, x))
            return false;
        x += moved;
        return true;
    });
}

double TangentSolve::force_of_rounding(const Eigen::VectorXd& u) const {
    double sum = 0;
    const Adjacency& graph = matrix_.graph;
    for (Index n = 0; n < matrix_.num_rows(); ++n)
        for (Index k = graph.offsets[n]; k < graph.offsets[n + 1]; ++k) {
            if (graph.items[k] != n) continue;
            // K_ii u_i eps: what a last bit of u makes of the force at i
            for (int i = 0; i < 3; ++i) sum += std::pow(matrix_.block(k)[4 * i] * u[3 * n + i], 2);
        }
    return 1e-14 * std::sqrt(sum);
}

}  // namespace palpate
