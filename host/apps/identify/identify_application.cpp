// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/identify_application.hpp"

#include <fmt/format.h>

#include <chrono>
#include <fstream>
#include <string>

#include "host/apps/compute_options.hpp"
#include "host/apps/identify/experiment_problem.hpp"
#include "host/apps/identify/identified_tree.hpp"
#include "host/apps/identify/mesh_check.hpp"
#include "host/apps/identify/planned_problem.hpp"
#include "host/estimate/multi_start.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::vector<Option> identify_table() {
    return joined(
        {{
             Option::input_file(
                 "experiment", "A model file of simulate with unknown numbers, and [[data]] (TOML)")
                 .positional()
                 .required(),
             Option::choice("method", {"map", "simplex", "bobyqa"},
                            "Search: map (Gauss-Newton), or without derivatives, for comparison")
                 .usually("map"),
             Option::flag("plan",
                          "The intervals to expect if what is measured is what the model says at "
                          "the starts; measured values are not used"),
             Option::choice("mesh_check", {"on", "off"},
                            "Solves once more with cells, and once with time steps, of half the "
                            "size, corrects the values for the difference and widens the intervals")
                 .usually("on"),
             Option::integer("starts", 1, 10000,
                             "Searches: from the parameters' starts, then from draws of the priors")
                 .usually(1),
             Option::output_file("starts_file",
                                 "Keeps a line for each start; one that is there goes on"),
             Option::integer("jobs", 1, 256, "Simulations at the same time; default: the cores"),
         },
         tangent_options()});
}

/// A file of starts: a line that says of what, then a line for each.
class StartsFile {
public:
    StartsFile(std::filesystem::path path, std::string heading)
        : path_(std::move(path)), heading_(std::move(heading)) {}

    /// Throws Error(invalid_argument) if it is of something else, Error(input_unreadable).
    std::vector<StartOutcome> read() const {
        std::vector<StartOutcome> outcomes;
        std::ifstream in(path_);
        std::string line;
        for (int number = 1; std::getline(in, line); ++number) {
            if (number == 1 && line != heading_)
                throw Error(ErrorCode::invalid_argument,
                            path_.string() +
                                " holds starts of another experiment, method or plan; "
                                "name another starts_file");
            if (number > 1 && !line.empty()) outcomes.push_back(start_outcome_of(line));
        }
        return outcomes;
    }

    void keep(const StartOutcome& outcome) const {
        const bool is_new = !std::filesystem::exists(path_);
        std::ofstream out(path_, std::ios::app);
        if (is_new) out << heading_ << '\n';
        out << json_line(outcome) << '\n' << std::flush;
        if (!out)
            throw Error(ErrorCode::output_failed,
                        "cannot write '" + path_.string() + "'; check its folder and free space");
    }

private:
    std::filesystem::path path_;
    std::string heading_;
};

/// Fits from one start or several; fills `found`.
void search(const DataProblem& problem, const OptionValues& values, IdentifiedExperiment& found,
            const ProgressSink& progress) {
    MultiStartOptions options;
    options.fit.method = fit_method_of(values.text("method"));
    options.num_start = found.is_plan ? 1 : values.integer("starts");
    found.num_start = options.num_start;
    const std::filesystem::path file = values.path("starts_file");
    if (options.num_start == 1 && file.empty()) {
        found.fit = fit(problem, options.fit, progress);
        return;
    }
    const StartsFile starts(
        file, fmt::format("# starts of {:016x} by {}{}", found.experiment.fingerprint(),
                          values.text("method"), found.is_plan ? ", planned" : ""));
    const auto earlier = file.empty() ? std::vector<StartOutcome>{} : starts.read();
    const auto keep = [&](const StartOutcome& outcome) {
        if (!file.empty()) starts.keep(outcome);
    };
    MultiStart all = fit_from_starts(problem, options, earlier, keep, progress);
    found.num_minimum = all.num_minimum;
    found.fit = std::move(all.best);
}

Outcome outcome_of(const IdentifiedExperiment& found, const std::filesystem::path& folder) {
    Outcome outcome{identified_tree(found)};
    outcome.text = identified_text(found);
    outcome.pictures = identified_pictures(found);
    outcome.files = {{"fit.csv", fit_csv(found)}};
    if (!found.is_plan && found.experiment.has_model())
        outcome.files.emplace_back("identified.toml",
                                   found.experiment.model_text(found.fit.values, folder));
    outcome.exit_code = found.converged() ? 0 : exit_code_not_converged;
    return outcome;
}

Outcome run_identify(const OptionValues& values, const ProgressSink& progress) {
    const auto begin = std::chrono::steady_clock::now();
    const Experiment experiment = Experiment::read(values.path("experiment"));
    const auto configured = [&](SimulationSettings& settings) {
        take_tangent_options(values, settings.newton);
    };
    const ExperimentProblem measured(experiment, configured, jobs_of(values), progress);
    IdentifiedExperiment found{.experiment = experiment, .is_plan = values.flag("plan")};
    std::optional<PlannedProblem> planned;
    if (found.is_plan) planned.emplace(measured);
    const DataProblem& problem = planned ? static_cast<const DataProblem&>(*planned) : measured;
    search(problem, values, found, progress);
    report_progress(progress, "intervals", 0, "");
    IdentifyOptions judging;
    judging.jobs = jobs_of(values);
    found.identified = identify(problem, found.fit, judging, progress);
    found.num_simulation = measured.num_simulation();
    if (!found.is_plan && experiment.has_model() && values.text("mesh_check") == "on")
        check_mesh(configured, found, progress);
    found.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return outcome_of(found, values.path("out"));
}

}  // namespace

Application identify_application() {
    return {"identify",
            "Tissue from an experiment: unknown numbers of a model from what was measured",
            identify_table(), run_identify};
}

}  // namespace palpate
