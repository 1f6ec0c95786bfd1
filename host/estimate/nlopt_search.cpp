// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/nlopt_search.hpp"

#include <nlopt.h>

#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <type_traits>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// What the library calls: no exception may cross it.
struct Trials {
    const std::function<double(const Eigen::VectorXd&)>& function;
    nlopt_opt optimiser;
    NloptMinimum lowest = {};
    std::exception_ptr failure = {};
};

double evaluate_trial(unsigned n, const double* x, double*, void* data) {
    auto& trials = *static_cast<Trials*>(data);
    try {
        const Eigen::VectorXd point = Eigen::Map<const Eigen::VectorXd>(x, n);
        const double value = trials.function(point);
        if (!std::isfinite(value))
            throw Error(ErrorCode::solve_failed,
                        "the search met an objective that is not a number");
        NloptMinimum& lowest = trials.lowest;
        if (lowest.evaluations++ == 0 || value < lowest.value) {
            lowest.x = point;
            lowest.value = value;
        }
        return value;
    } catch (...) {
        trials.failure = std::current_exception();
        nlopt_force_stop(trials.optimiser);
        return std::numeric_limits<double>::infinity();
    }
}

}  // namespace

NloptMinimum minimise_with_nlopt(NloptSearch search,
                                 const std::function<double(const Eigen::VectorXd&)>& function,
                                 const Eigen::VectorXd& start, const NloptOptions& options) {
    const nlopt_algorithm algorithm =
        search == NloptSearch::bobyqa ? NLOPT_LN_BOBYQA : NLOPT_LN_NELDERMEAD;
    const std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)> optimiser(
        nlopt_create(algorithm, static_cast<unsigned>(start.size())), nlopt_destroy);
    if (!optimiser) throw Error(ErrorCode::out_of_memory, "NLopt could not make an optimiser");
    Trials trials{function, optimiser.get()};
    nlopt_set_lower_bounds1(optimiser.get(), options.lower);
    nlopt_set_upper_bounds1(optimiser.get(), options.upper);
    nlopt_set_initial_step1(optimiser.get(), options.first_step);
    nlopt_set_xtol_abs1(optimiser.get(), options.tolerance);
    nlopt_set_maxeval(optimiser.get(), options.max_evaluations);
    nlopt_set_min_objective(optimiser.get(), evaluate_trial, &trials);
    Eigen::VectorXd x = start.cwiseMax(options.lower).cwiseMin(options.upper);
    double value = 0;
    // However it ends, the trials made until then count.
    const nlopt_result ending = nlopt_optimize(optimiser.get(), x.data(), &value);
    if (trials.failure) std::rethrow_exception(trials.failure);
    if (trials.lowest.evaluations == 0)
        throw Error(ErrorCode::internal, "NLopt evaluated no point at all");
    trials.lowest.converged = ending == NLOPT_XTOL_REACHED || ending == NLOPT_SUCCESS;
    return trials.lowest;
}

}  // namespace palpate
