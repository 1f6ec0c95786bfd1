// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/derivative_free_search.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// How far, in steps, the search may go from its start.
constexpr double max_steps_away = 40.0;
/// The search ends when it would change unknowns by less than this share of a step.
constexpr double step_tolerance = 1e-4;

double step_of(const Parameter& parameter) {
    if (parameter.transform != Transform::identity) return 0.3;
    if (parameter.has_prior()) return parameter.sd;
    return parameter.start != 0 ? 0.1 * std::abs(parameter.start) : 1.0;
}

/// Minus the log posterior at numbers of steps away from the start.
class StepObjective {
public:
    StepObjective(const DataProblem& problem, const NoiseModel& noise,
                  const GaussNewtonStart& start, const ProgressSink& progress)
        : problem_(problem),
          noise_(noise),
          start_(to_transformed(problem.parameters(), start.values)),
          steps_(start.values.size()),
          nearest_(start.warm),
          progress_(progress) {
        for (Index k = 0; k < steps_.size(); ++k) steps_[k] = step_of(problem.parameters()[k]);
        for (const Index k : start.held) steps_[k] = 0;
        for (const Index k : held_of(problem.parameters())) steps_[k] = 0;
    }

    double operator()(const Eigen::VectorXd& steps);
    Eigen::VectorXd values(const Eigen::VectorXd& steps) const;
    int num_prediction() const { return num_prediction_; }
    int num_failed() const { return num_failed_; }
    const std::shared_ptr<const Prediction>& nearest() const { return nearest_; }

private:
    const DataProblem& problem_;
    NoiseModel noise_;
    Eigen::VectorXd start_, steps_;
    std::shared_ptr<const Prediction> nearest_;  ///< of the lowest objective
    double lowest_ = std::numeric_limits<double>::infinity();
    double highest_ = -std::numeric_limits<double>::infinity();
    int num_prediction_ = 0, num_failed_ = 0;
    const ProgressSink& progress_;
};

Eigen::VectorXd StepObjective::values(const Eigen::VectorXd& steps) const {
    const TransformedRange range = range_of(problem_.parameters());
    return to_values(
        problem_.parameters(),
        (start_ + steps.cwiseProduct(steps_)).cwiseMax(range.lower).cwiseMin(range.upper));
}

double StepObjective::operator()(const Eigen::VectorXd& steps) {
    check_cancelled(progress_);
    ++num_prediction_;
    const PredictionAttempt made =
        checked_prediction(problem_, values(steps), PredictedColumns::none, nearest_.get());
    if (!made.prediction) {
        ++num_failed_;
        if (num_prediction_ == 1)
            throw Error(ErrorCode::solve_failed,
                        fmt::format("the model has no prediction at the start: {}", made.failure));
        return highest_ + 1.0 + std::abs(highest_);
    }
    noise_.reweight(*made.prediction);
    const double value =
        noise_.misfit(*made.prediction) +
        priors_of(problem_.parameters())
            .energy(to_transformed(problem_.parameters(), made.prediction->values));
    highest_ = std::max(highest_, value);
    if (value < lowest_) {
        lowest_ = value;
        nearest_ = made.prediction;
        report_progress(progress_, "searching", -1,
                        fmt::format("evaluation {}: misfit {:.4f}", num_prediction_, value));
    }
    return value;
}

}  // namespace

GaussNewtonMinimum minimise_without_columns(const DataProblem& problem, NoiseModel& noise,
                                            const GaussNewtonStart& start, NloptSearch search,
                                            int max_evaluations, const ProgressSink& progress) {
    StepObjective objective(problem, noise, start, progress);
    const NloptOptions options{-max_steps_away, max_steps_away, 1.0, step_tolerance,
                               max_evaluations};
    const NloptMinimum found = minimise_with_nlopt(
        search, [&](const Eigen::VectorXd& steps) { return objective(steps); },
        Eigen::VectorXd::Zero(start.values.size()), options);
    // Columns at the end, without a step.
    GaussNewtonOptions no_step;
    no_step.max_steps = 0;
    GaussNewtonMinimum minimum = minimise_gauss_newton(
        problem, noise, {objective.values(found.x), objective.nearest(), start.held}, no_step,
        progress);
    minimum.ending = found.converged ? Ending::converged : Ending::too_many_steps;
    minimum.num_prediction += objective.num_prediction();
    minimum.num_failed += objective.num_failed();
    return minimum;
}

}  // namespace palpate
