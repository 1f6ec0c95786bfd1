// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/mesh_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "host/apps/identify/experiment_problem.hpp"
#include "host/apps/identify/resolution.hpp"
#include "host/estimate/discretisation.hpp"
#include "host/page/plain_text.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr const char* steps = "time steps";

using Configure = std::function<void(SimulationSettings&)>;

/// A fit's values on cells or time steps of half the size; null if these cannot be halved.
std::shared_ptr<const Prediction> predict_finer(const Experiment& experiment, const Fit& fit,
                                                bool (*halve)(SimulationSettings&),
                                                const Configure& configure,
                                                IdentifiedExperiment& found,
                                                const ProgressSink& progress) {
    bool is_halved = false;
    const ExperimentProblem finer(
        experiment,
        [&](SimulationSettings& settings) {
            configure(settings);
            is_halved = halve(settings);
            if (!is_halved) throw Error(ErrorCode::solve_failed, "it cannot be made finer");
        },
        1, progress);
    PredictionAttempt made;
    try {
        made = checked_prediction(finer, fit.values, PredictedColumns::none, nullptr);
    } catch (const Error& error) {
        // What a finer mesh cannot do is said; the fit stands.
        if (error.code() == ErrorCode::cancelled || error.code() == ErrorCode::time_limit) throw;
        made.failure = error.what();
    }
    found.num_simulation += is_halved;
    if (is_halved && !made.prediction)
        found.mesh_check_sentence =
            "The finer model could not be solved (" + made.failure + "): intervals lack its error.";
    return made.prediction;
}

std::string corrected_sentence(const std::string& by) {
    return fmt::format("Values are corrected by {}; the intervals have what that leaves unknown.",
                       by);
}

/// `shifts` out of the values and into the intervals; a warning where they are large.
void correct(const std::vector<Eigen::VectorXd>& shifts, IdentifiedExperiment& found,
             const Eigen::VectorXd& model_sd) {
    correct_for_discretisation(shifts, found.fit, found.identified, model_sd);
    found.is_mesh_checked = true;
    std::string far;
    for (std::size_t k = 0; k < found.identified.parameters.size(); ++k) {
        const IdentifiedParameter& one = found.identified.parameters[k];
        if (one.judgement.verdict == Verdict::not_identifiable) continue;  // and was not moved
        const auto at = Eigen::Index(k);
        const double sd = std::hypot(one.sd, model_sd.size() > 0 ? model_sd[at] : 0.0);
        double squares = 0;  // shifts of opposite signs may hide each other in their sum
        for (const Eigen::VectorXd& shift : shifts) squares += shift[at] * shift[at];
        const double size =
            std::max(std::abs(one.discretisation_shift), 4.0 / 3.0 * std::sqrt(squares));
        if (size > sd && !one.parameter.is_nuisance)
            far += fmt::format("{}{} by {:.1f} sd", far.empty() ? "" : ", ",
                               harmless(label_of(one.parameter)), size / sd);
    }
    if (!far.empty())
        found.mesh_check_sentence +=
            " Warning: that moved " + far + "; refine mesh and time steps.";
}

}  // namespace

void check_mesh(const Configure& configure, IdentifiedExperiment& found,
                const ProgressSink& progress, const Eigen::VectorXd& model_sd) {
    const auto& parameters = found.experiment.parameters();
    std::vector<Eigen::VectorXd> shifts;
    std::string what;
    const auto add = [&](const char* name, bool (*halve)(SimulationSettings&)) {
        report_progress(progress, "mesh check", -1, name);
        const auto finer =
            predict_finer(found.experiment, found.fit, halve, configure, found, progress);
        if (!finer) return;
        shifts.push_back(shift_by_discretisation(parameters, found.fit, *finer));
        what += (what.empty() ? "" : " and ") + std::string(name);
    };
    add("cells", halve_cells);
    add(steps, halve_steps);
    if (!found.mesh_check_sentence.empty()) shifts.clear();
    if (shifts.empty() && model_sd.size() > 0)
        correct_for_discretisation({}, found.fit, found.identified, model_sd);
    if (!found.mesh_check_sentence.empty()) return;
    if (shifts.empty()) {
        found.mesh_check_sentence =
            "A mesh of a file cannot be refined here: its error is not in the intervals.";
        return;
    }
    found.mesh_check_sentence = corrected_sentence("a run with " + what + " of half the size");
    correct(shifts, found, model_sd);
    if (what == steps)
        found.mesh_check_sentence +=
            " A mesh of a file cannot be refined here: its error is not in the intervals.";
}

void check_mesh(const std::vector<HalvedModel>& pairs, IdentifiedExperiment& found,
                const Eigen::VectorXd& model_sd) {
    std::vector<Eigen::VectorXd> shifts;
    for (const HalvedModel& pair : pairs)
        shifts.push_back(shift_by_discretisation(found.experiment.parameters(), found.fit,
                                                 *pair.halved, *pair.usual));
    found.mesh_check_sentence = corrected_sentence(
        "runs with cells and with time steps of half the size, each with the other of twice the "
        "size");
    correct(shifts, found, model_sd);
}

}  // namespace palpate
