// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/fit.hpp"

#include <fmt/core.h>

#include <cmath>
#include <random>
#include <utility>

#include "host/estimate/derivative_free_search.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Draws from the priors that are tried when neither start nor medians have a prediction.
constexpr int max_drawn_starts = 10;
/// Of the misfit: what the first of several searches may leave to gain. Without a discrepancy the
/// data are taken to be far more precise than the model can be, and the end is not worth finding.
constexpr double first_gain_share = 0.1;
/// Of ln posterior: what searches between may leave, whose discrepancies are still to change.
constexpr double gain_between = 0.1;
constexpr std::uint32_t start_seed = 20090601;

struct FirstPrediction {
    std::shared_ptr<const Prediction> prediction;
    std::string note;  ///< which start it is of, if not the first
};

Eigen::VectorXd medians_of(const std::vector<Parameter>& parameters) {
    return to_values(parameters, priors_of(parameters).mean);
}

/// The first start at which the model has a prediction.
FirstPrediction first_prediction(const DataProblem& problem, const FitOptions& options,
                                 const ProgressSink& progress) {
    const std::vector<Parameter>& parameters = problem.parameters();
    std::mt19937 random(start_seed);
    const Eigen::VectorXd start = options.start.size() != 0 ? options.start : starts_of(parameters);
    const int num_start = options.tries_other_starts ? 2 + max_drawn_starts : 1;
    std::string first_failure;
    for (int k = 0; k < num_start; ++k) {
        check_cancelled(progress);
        Eigen::VectorXd values = k == 0   ? start
                                 : k == 1 ? medians_of(parameters)
                                          : draw_from_priors(parameters, random);
        for (const Index held : options.held) values[held] = start[held];
        PredictionAttempt made = checked_prediction(problem, values, PredictedColumns::wanted,
                                                    k == 0 ? options.warm.get() : nullptr);
        if (!made.prediction && k == 0 && options.warm)
            made = checked_prediction(problem, values, PredictedColumns::wanted, nullptr);
        if (made.prediction) {
            const char* note = k == 0   ? ""
                               : k == 1 ? "the priors' medians"
                                        : "a draw of the priors";
            return {made.prediction, note};
        }
        if (k == 0) first_failure = made.failure;
        if (k == 0 && options.warm && options.warm->values != start) {
            made = checked_prediction(problem, options.warm->values, PredictedColumns::wanted,
                                      options.warm.get());
            if (made.prediction) return {made.prediction, "that of an earlier prediction"};
        }
    }
    throw Error(
        ErrorCode::solve_failed,
        fmt::format("the model has no prediction at any of {} starts (first the one that was "
                    "asked for: {}); give another start",
                    num_start, first_failure));
}

void check_fit_options(const DataProblem& problem, const FitOptions& options) {
    check_parameters(problem.parameters());
    const auto count = static_cast<Eigen::Index>(problem.parameters().size());
    if (options.start.size() != 0 && options.start.size() != count)
        throw Error(
            ErrorCode::invalid_argument,
            fmt::format("the start has {} numbers for {} parameters", options.start.size(), count));
}

void set_given(NoiseModel& noise, const std::vector<Discrepancy>& given) {
    if (given.empty()) return;
    if (static_cast<Index>(given.size()) != noise.num_block())
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("{} discrepancies were given for {} blocks of data", given.size(),
                                noise.num_block()));
    for (Index b = 0; b < noise.num_block(); ++b) noise.set_discrepancy(b, given[b]);
}

/// Whether learning again has changed nothing that counts. An amplitude far below the noise may
/// change as it likes, and lengths then mean nothing.
bool is_settled(const NoiseModel& noise, const std::vector<Discrepancy>& learned,
                const Prediction& prediction, double tolerance) {
    for (Index b = 0; b < noise.num_block(); ++b) {
        const Discrepancy &before = noise.discrepancy(b), &after = learned[b];
        const double negligible = 0.1 * prediction.blocks[b].sd.minCoeff();
        if (std::max(before.amplitude, after.amplitude) <= negligible) continue;
        const auto differs = [&](double x, double y, double allowed) {
            return std::abs(std::log(x / y)) > allowed;
        };
        if (before.amplitude == 0 || differs(before.amplitude, after.amplitude, tolerance) ||
            differs(before.length_mm, after.length_mm, 3 * tolerance) ||
            differs(before.length_s, after.length_s, 3 * tolerance))
            return false;
    }
    return true;
}

/// Searches that follow each other, and what they cost together.
class FitRounds {
public:
    FitRounds(const DataProblem& problem, const FitOptions& options, const ProgressSink& progress)
        : problem_(problem), options_(options), progress_(progress) {}

    /// `left_gain`, `left_share`: what may be left to gain, and the share of the misfit.
    GaussNewtonMinimum search(NoiseModel& noise, const GaussNewtonStart& start,
                              double left_gain = 0, double left_share = 0);
    void write_counts(Fit& fit) const;

private:
    const DataProblem& problem_;
    const FitOptions& options_;
    const ProgressSink& progress_;
    int num_round_ = 0, num_step_ = 0, num_prediction_ = 0, num_failed_ = 0;
};

GaussNewtonMinimum FitRounds::search(NoiseModel& noise, const GaussNewtonStart& start,
                                     double left_gain, double left_share) {
    GaussNewtonOptions gauss_newton = options_.gauss_newton;
    gauss_newton.gain_tolerance = std::max(gauss_newton.gain_tolerance, left_gain);
    gauss_newton.gain_share = std::max(gauss_newton.gain_share, left_share);
    GaussNewtonMinimum minimum =
        options_.method == FitMethod::map
            ? minimise_gauss_newton(problem_, noise, start, gauss_newton, progress_)
            : minimise_without_columns(problem_, noise, start,
                                       options_.method == FitMethod::simplex
                                           ? NloptSearch::nelder_mead
                                           : NloptSearch::bobyqa,
                                       options_.max_evaluations, progress_);
    ++num_round_;
    num_step_ += static_cast<int>(minimum.trials.size());
    num_prediction_ += minimum.num_prediction;
    num_failed_ += minimum.num_failed;
    return minimum;
}

void FitRounds::write_counts(Fit& fit) const {
    fit.num_round = num_round_;
    fit.num_step = num_step_;
    fit.num_prediction = num_prediction_;
    fit.num_failed = num_failed_;
}

double discrepancy_energy(const std::vector<Parameter>& parameters, const Prediction& prediction,
                          const NoiseModel& noise) {
    const std::vector<DiscrepancyRange> ranges = discrepancy_ranges(parameters, prediction, noise);
    double sum = 0;
    for (Index b = 0; b < noise.num_block(); ++b)
        if (noise.discrepancy(b).amplitude > 0) sum -= log_prior(ranges[b], noise.discrepancy(b));
    return sum;
}

Fit as_fit(const std::vector<Parameter>& parameters, GaussNewtonMinimum minimum,
           const NoiseModel& noise, FitMethod method) {
    Fit fit;
    fit.values = minimum.values;
    fit.transformed = minimum.transformed;
    fit.prediction = minimum.prediction;
    fit.noise = std::make_shared<const NoiseModel>(noise);
    fit.equations = minimum.equations;
    fit.objective = minimum.objective + discrepancy_energy(parameters, *minimum.prediction, noise);
    fit.method = method;
    fit.ending = minimum.ending;
    return fit;
}

}  // namespace

const char* name_of(FitMethod method) {
    switch (method) {
        case FitMethod::map:
            return "map";
        case FitMethod::simplex:
            return "simplex";
        case FitMethod::bobyqa:
            return "bobyqa";
    }
    return "map";
}

FitMethod fit_method_of(std::string_view words) {
    for (const FitMethod method : {FitMethod::map, FitMethod::simplex, FitMethod::bobyqa})
        if (words == name_of(method)) return method;
    throw Error(
        ErrorCode::invalid_argument,
        fmt::format("\"{}\" is no method of a fit; allowed: \"map\", \"simplex\", \"bobyqa\"",
                    words));
}

Eigen::VectorXd draw_from_priors(const std::vector<Parameter>& parameters, std::mt19937& random) {
    const TransformedPriors priors = priors_of(parameters);
    const TransformedRange range = range_of(parameters);
    std::normal_distribution<double> normal;
    Eigen::VectorXd drawn(parameters.size());
    for (Index k = 0; k < drawn.size(); ++k) {
        const Parameter& parameter = parameters[k];
        const double sd = parameter.is_held                            ? 0.0
                          : parameter.has_prior()                      ? parameter.sd
                          : parameter.transform != Transform::identity ? 1.0
                                                                       : std::abs(parameter.start);
        drawn[k] = std::clamp(priors.mean[k] + sd * normal(random), range.lower[k], range.upper[k]);
    }
    return to_values(parameters, drawn);
}

Eigen::VectorXd quadratic_minimum(const std::vector<Parameter>& parameters, const Fit& found,
                                  double most_gain) {
    const Eigen::VectorXd step = quadratic_step(parameters, found.transformed, found.equations);
    const double gain = quadratic_gain(found.equations, step);
    if (!(gain > 0 && gain <= most_gain)) return found.values;
    return to_values(parameters, found.transformed + step);
}

Fit fit(const DataProblem& problem, const FitOptions& options, const ProgressSink& progress) {
    check_fit_options(problem, options);
    const std::vector<Parameter>& parameters = problem.parameters();
    const FirstPrediction first = first_prediction(problem, options, progress);
    NoiseModel noise(first.prediction->blocks, options.noise);
    set_given(noise, options.discrepancy.given);
    FitRounds rounds(problem, options, progress);
    GaussNewtonMinimum minimum = rounds.search(
        noise, {first.prediction->values, first.prediction, options.held}, 0,
        options.discrepancy.is_learned && options.discrepancy.given.empty() ? first_gain_share
                                                                            : 0.0);
    bool has_settled = !options.discrepancy.is_learned;
    for (int round = 0; !has_settled && round < options.discrepancy.max_rounds; ++round) {
        const std::vector<Discrepancy> learned =
            learn_discrepancies(parameters, *minimum.prediction, noise, progress);
        has_settled =
            is_settled(noise, learned, *minimum.prediction, options.discrepancy.tolerance);
        for (Index b = 0; b < noise.num_block(); ++b) noise.set_discrepancy(b, learned[b]);
        minimum = rounds.search(noise, {minimum.values, minimum.prediction, options.held},
                                has_settled ? 0.0 : gain_between);
    }
    Fit result = as_fit(parameters, std::move(minimum), noise, options.method);
    result.is_settled = has_settled;
    if (options.discrepancy.is_learned)
        result.discrepancy_covariance =
            discrepancy_covariances(parameters, *result.prediction, noise);
    result.start_note = first.note;
    rounds.write_counts(result);
    ++result.num_prediction;
    return result;
}

}  // namespace palpate
