// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/inverse/lbfgs.hpp"

#include <nlopt.h>

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

/// What the library calls: no exception may cross it.
struct Evaluation {
    const DifferentiableFunction& function;
    nlopt_opt optimiser;
    LbfgsResult best;
    std::exception_ptr failure;

    double at(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
        const double value = function(x, gradient);
        if (++best.evaluations == 1 || value < best.value) {
            best.value = value;
            best.x = x;
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

}  // namespace

LbfgsResult minimise_lbfgs(const DifferentiableFunction& function, const Eigen::VectorXd& x,
                           const LbfgsOptions& options) {
    const Optimiser optimiser = make_optimiser(x.size(), options);
    Evaluation evaluation{function, optimiser.get(), {}, {}};
    nlopt_set_min_objective(optimiser.get(), call_back, &evaluation);
    Eigen::VectorXd end = x;
    double value = 0;
    const nlopt_result code = nlopt_optimize(optimiser.get(), end.data(), &value);
    if (evaluation.failure) std::rethrow_exception(evaluation.failure);
    if (code == NLOPT_INVALID_ARGS)
        throw Error(ErrorCode::invalid_argument,
                    "NLopt refused the problem: the start must lie within the bounds");
    explain(code, evaluation.best);
    return evaluation.best;
}

}  // namespace palpate
