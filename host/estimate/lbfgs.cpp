// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/lbfgs.hpp"

#include <nlopt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <type_traits>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Remembered steps. The library's own choice grows with free memory to hundreds of vectors.
constexpr unsigned num_remembered_steps = 10;

using Optimiser = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)>;

/// Other starts that are tried when the objective has no finite value at the one that was given.
constexpr int num_starts = 3;
constexpr double shift = 1e-3;       ///< between them
constexpr double stationary = 1e-6;  ///< projected gradient, relative to 1 + |value|
/// Searches that may begin again at the best point: of an objective that is not finite now and
/// then, or whose kinks let a line search find nothing lower.
constexpr int most_restarts = 2;

/// What the library calls: no exception may cross it, and nothing that is not finite.
struct Evaluation {
    const DifferentiableFunction& function;
    nlopt_opt optimiser;
    LbfgsResult best = {};
    Eigen::VectorXd gradient = {};  ///< at `best`
    int num_not_finite = 0;
    std::exception_ptr failure = {};

    double at(const Eigen::VectorXd& x, Eigen::VectorXd& slope) {
        if (best.x.size() == x.size() &&
            best.x == x) {  // the library begins where the last search ended
            slope = gradient;
            return best.value;
        }
        ++best.evaluations;
        const double value = function(x, slope);
        if (!std::isfinite(value) || !slope.allFinite()) {
            ++num_not_finite;
            slope.setZero();
            return best.value + std::abs(best.value) + 1;  // a wall: the line search turns back
        }
        if (best.x.size() == 0 || value < best.value) {
            best.value = value;
            best.x = x;
            gradient = slope;
        }
        return value;
    }
};

double call_back(unsigned n, const double* x, double* gradient, void* data) {
    auto& evaluation = *static_cast<Evaluation*>(data);
    try {
        Eigen::VectorXd slope = Eigen::VectorXd::Zero(n);
        const double value = evaluation.at(Eigen::Map<const Eigen::VectorXd>(x, n), slope);
        if (gradient) Eigen::Map<Eigen::VectorXd>(gradient, n) = slope;
        return value;
    } catch (...) {
        evaluation.failure = std::current_exception();
        nlopt_force_stop(evaluation.optimiser);
        return std::numeric_limits<double>::infinity();
    }
}

Optimiser make_optimiser(Eigen::Index n, const LbfgsOptions& options) {
    Optimiser optimiser(nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(n)), nlopt_destroy);
    if (!optimiser) throw Error(ErrorCode::out_of_memory, "NLopt could not make an optimiser");
    nlopt_set_ftol_rel(optimiser.get(), options.relative_tolerance);
    nlopt_set_maxeval(optimiser.get(), options.max_evaluations);
    if (options.time_limit_s > 0) nlopt_set_maxtime(optimiser.get(), options.time_limit_s);
    nlopt_set_vector_storage(optimiser.get(), num_remembered_steps);
    if (options.lower.size() == n) nlopt_set_lower_bounds(optimiser.get(), options.lower.data());
    if (options.upper.size() == n) nlopt_set_upper_bounds(optimiser.get(), options.upper.data());
    return optimiser;
}

void explain(nlopt_result code, LbfgsResult& result) {
    switch (code) {
        case NLOPT_SUCCESS:
            result.converged = true;
            result.reason = "the gradient vanished";
            return;
        case NLOPT_FTOL_REACHED:
            result.converged = true;
            result.reason = "two steps in a row changed the objective by less than the tolerance";
            return;
        case NLOPT_MAXEVAL_REACHED:
            result.reason = "the allowed number of evaluations was used up";
            return;
        case NLOPT_MAXTIME_REACHED:
            result.reason = "the time limit was reached";
            return;
        case NLOPT_ROUNDOFF_LIMITED:
            result.reason = "rounding errors stopped the search";
            return;
        default:
            result.reason = "the line search found no lower point (a kink or noise)";
    }
}

Eigen::VectorXd within(const Eigen::VectorXd& x, const LbfgsOptions& options) {
    Eigen::VectorXd inside = x;
    if (options.lower.size() == x.size()) inside = inside.cwiseMax(options.lower);
    if (options.upper.size() == x.size()) inside = inside.cwiseMin(options.upper);
    return inside;
}

/// How far a step of minus the gradient leads within the bounds.
double projected_gradient(const Eigen::VectorXd& x, const Eigen::VectorXd& gradient,
                          const LbfgsOptions& options) {
    return (within(x - gradient, options) - x).norm();
}

/// Finds a place with a finite value, at `x` or beside it.
void evaluate_start(Evaluation& evaluation, const Eigen::VectorXd& x, const LbfgsOptions& options) {
    for (int k = 0; k < num_starts && evaluation.best.x.size() == 0; ++k) {
        Eigen::VectorXd slope = Eigen::VectorXd::Zero(x.size());
        evaluation.at(within((x.array() + k * shift).matrix(), options), slope);
    }
    if (evaluation.best.x.size() == 0)
        throw Error(ErrorCode::solve_failed,
                    "the objective is not a finite number where the search starts, nor beside it; "
                    "check the settings for extreme values");
}

}  // namespace

LbfgsResult minimise_lbfgs(const DifferentiableFunction& function, const Eigen::VectorXd& x,
                           const LbfgsOptions& options) {
    if (within(x, options) != x)
        throw Error(ErrorCode::invalid_argument,
                    "the start of a search must be finite and lie within the bounds");
    const Optimiser optimiser = make_optimiser(x.size(), options);
    Evaluation evaluation{function, optimiser.get()};
    nlopt_set_min_objective(optimiser.get(), call_back, &evaluation);
    evaluate_start(evaluation, x, options);
    LbfgsResult& best = evaluation.best;
    best.start_gradient = projected_gradient(best.x, evaluation.gradient, options);
    const double start_value = best.value;
    nlopt_result code = NLOPT_FAILURE;
    const auto start = std::chrono::steady_clock::now();
    for (int restart = 0; restart <= most_restarts; ++restart) {
        const int bad_before = evaluation.num_not_finite;
        const double value_before = best.value;
        if (options.time_limit_s > 0 && restart > 0) {
            const std::chrono::duration<double> used = std::chrono::steady_clock::now() - start;
            if (used.count() >= options.time_limit_s) {
                code = NLOPT_MAXTIME_REACHED;
                break;
            }
            nlopt_set_maxtime(optimiser.get(), options.time_limit_s - used.count());
        }
        // 0 would be no limit.
        nlopt_set_maxeval(optimiser.get(), std::max(1, options.max_evaluations - best.evaluations));
        Eigen::VectorXd end = best.x;
        double value = 0;
        code = nlopt_optimize(optimiser.get(), end.data(), &value);
        if (evaluation.failure) std::rethrow_exception(evaluation.failure);
        const bool is_finite = evaluation.num_not_finite == bad_before;
        const bool is_stuck = code == NLOPT_FAILURE && best.value < value_before;
        if (is_finite && !is_stuck) break;
        if (best.evaluations >= options.max_evaluations) {
            if (code == NLOPT_FAILURE) code = NLOPT_MAXEVAL_REACHED;
            break;
        }
    }
    explain(code, best);
    best.gradient = projected_gradient(best.x, evaluation.gradient, options);
    if (best.converged && best.value >= start_value &&
        best.gradient > stationary * (1 + std::abs(best.value))) {
        best.converged = false;
        best.reason = "the search ended where it began, which is no minimum";
    }
    return best;
}

}  // namespace palpate
