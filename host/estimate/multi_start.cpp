// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/multi_start.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Json = nlohmann::json;

std::vector<double> numbers_of(const Eigen::VectorXd& vector) {
    return {vector.begin(), vector.end()};
}

Eigen::VectorXd vector_of(const std::vector<double>& numbers) {
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Index>(numbers.size()));
}

Ending ending_of(const std::string& words) {
    for (const Ending ending : {Ending::converged, Ending::too_many_steps, Ending::stalled})
        if (words == name_of(ending)) return ending;
    throw Error(ErrorCode::input_unreadable,
                fmt::format("\"{}\" is no end of a search; allowed: \"converged\", \"too many "
                            "steps\", \"stalled\"",
                            words));
}

StartOutcome outcome_of_json(const Json& json) {
    StartOutcome outcome;
    outcome.number = json.at("number").get<int>();
    outcome.start = vector_of(json.at("start").get<std::vector<double>>());
    outcome.values = vector_of(json.at("values").get<std::vector<double>>());
    outcome.objective = json.at("minus_log_posterior").get<double>();
    outcome.ending = ending_of(json.at("ending").get<std::string>());
    for (const Json& field : json.at("discrepancies"))
        outcome.discrepancies.push_back({field.at("amplitude").get<double>(),
                                         field.at("length_mm").get<double>(),
                                         field.at("length_s").get<double>()});
    outcome.num_prediction = json.at("predictions").get<int>();
    outcome.failure = json.at("failure").get<std::string>();
    return outcome;
}

StartOutcome compute_outcome(const DataProblem& problem, const FitOptions& shared, int number,
                             const Eigen::VectorXd& start, const ProgressSink& progress) {
    StartOutcome outcome;
    outcome.number = number;
    outcome.start = start;
    FitOptions options = shared;
    options.start = start;
    options.tries_other_starts = false;
    try {
        const Fit found = fit(problem, options, progress);
        outcome.values = found.values;
        outcome.objective = found.objective;
        outcome.ending = found.ending;
        outcome.num_prediction = found.num_prediction;
        for (Index b = 0; b < found.noise->num_block(); ++b)
            outcome.discrepancies.push_back(found.noise->discrepancy(b));
    } catch (const Error& error) {
        if (error.code() != ErrorCode::solve_failed) throw;
        outcome.failure = error.what();
    }
    return outcome;
}

const StartOutcome* kept_outcome(const std::vector<StartOutcome>& earlier, int number,
                                 const Eigen::VectorXd& start) {
    const auto found = std::find_if(earlier.begin(), earlier.end(), [&](const StartOutcome& kept) {
        return kept.number == number && kept.start.size() == start.size() && kept.start == start;
    });
    return found == earlier.end() ? nullptr : &*found;
}

const StartOutcome& lowest_outcome(const std::vector<StartOutcome>& outcomes) {
    const StartOutcome* best = nullptr;
    for (const StartOutcome& outcome : outcomes)
        if (outcome.is_found() && (!best || outcome.objective < best->objective)) best = &outcome;
    if (best) return *best;
    throw Error(ErrorCode::solve_failed,
                fmt::format("none of {} starts has a prediction; the first: {}", outcomes.size(),
                            outcomes.empty() ? "there is none" : outcomes.front().failure));
}

/// Ends farther apart than a posterior sd in any parameter are different minima.
int count_minima(const std::vector<Parameter>& parameters,
                 const std::vector<StartOutcome>& outcomes, const Fit& best) {
    const Eigen::VectorXd sd =
        best.equations.hessian.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd allowed = best.equations.hessian.ldlt()
                                        .solve(Eigen::MatrixXd::Identity(sd.size(), sd.size()))
                                        .diagonal()
                                        .cwiseMax(sd.cwiseAbs2())
                                        .cwiseSqrt();
    std::vector<Eigen::VectorXd> minima;
    for (const StartOutcome& outcome : outcomes) {
        if (!outcome.is_found()) continue;
        const Eigen::VectorXd end = to_transformed(parameters, outcome.values);
        const bool is_known = std::any_of(minima.begin(), minima.end(), [&](const auto& minimum) {
            return ((end - minimum).cwiseAbs().array() <= allowed.array()).all();
        });
        if (!is_known) minima.push_back(end);
    }
    return static_cast<int>(minima.size());
}

Fit refit(const DataProblem& problem, const FitOptions& shared, const StartOutcome& best,
          const ProgressSink& progress) {
    FitOptions options = shared;
    options.start = best.values;
    options.discrepancy.given = best.discrepancies;
    options.method = FitMethod::map;
    return fit(problem, options, progress);
}

}  // namespace

std::string json_line(const StartOutcome& outcome) {
    Json fields = Json::array();
    for (const Discrepancy& field : outcome.discrepancies)
        fields.push_back({{"amplitude", field.amplitude},
                          {"length_mm", field.length_mm},
                          {"length_s", field.length_s}});
    const Json json = {{"number", outcome.number},
                       {"start", numbers_of(outcome.start)},
                       {"values", numbers_of(outcome.values)},
                       {"minus_log_posterior", outcome.objective},
                       {"ending", name_of(outcome.ending)},
                       {"discrepancies", fields},
                       {"predictions", outcome.num_prediction},
                       {"failure", outcome.failure}};
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

StartOutcome start_outcome_of(std::string_view line) {
    try {
        return outcome_of_json(Json::parse(line));
    } catch (const Json::exception& error) {
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("a kept start cannot be read: {}; remove the line to compute it "
                                "again",
                                error.what()));
    }
}

std::vector<Eigen::VectorXd> draw_starts(const std::vector<Parameter>& parameters,
                                         const MultiStartOptions& options) {
    if (!options.starts.empty()) return options.starts;
    std::vector<Eigen::VectorXd> starts;
    std::mt19937 random(options.seed);
    for (int k = 0; k < options.num_start; ++k)
        starts.push_back(k == 0 ? starts_of(parameters) : draw_from_priors(parameters, random));
    return starts;
}

MultiStart fit_from_starts(const DataProblem& problem, const MultiStartOptions& options,
                           const std::vector<StartOutcome>& earlier,
                           const std::function<void(const StartOutcome&)>& keep,
                           const ProgressSink& progress) {
    check_parameters(problem.parameters());
    const std::vector<Eigen::VectorXd> starts = draw_starts(problem.parameters(), options);
    MultiStart result;
    for (std::size_t k = 0; k < starts.size(); ++k) {
        const int number = static_cast<int>(k);
        report_progress(progress, "starts",
                        static_cast<double>(k) / static_cast<double>(starts.size()),
                        fmt::format("start {} of {}", k + 1, starts.size()));
        if (const StartOutcome* kept = kept_outcome(earlier, number, starts[k])) {
            result.outcomes.push_back(*kept);
            continue;
        }
        result.outcomes.push_back(
            compute_outcome(problem, options.fit, number, starts[k], progress));
        if (keep) keep(result.outcomes.back());
    }
    result.best = refit(problem, options.fit, lowest_outcome(result.outcomes), progress);
    result.num_minimum = count_minima(problem.parameters(), result.outcomes, result.best);
    return result;
}

}  // namespace palpate
