// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/plan_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "host/apps/aspirate/model/aspiration_model.hpp"
#include "host/apps/aspirate/tissue_experiment.hpp"
#include "host/apps/aspirate/tissue_fit.hpp"
#include "host/apps/aspirate/tissue_models.hpp"
#include "host/apps/compute_options.hpp"
#include "host/apps/identify/experiment_problem.hpp"
#include "host/apps/identify/identified_tree.hpp"
#include "host/apps/identify/planned_problem.hpp"
#include "host/apps/simulate/surface_profile.hpp"
#include "host/estimate/discretisation.hpp"
#include "host/io/output_folder.hpp"
#include "host/page/page.hpp"
#include "host/page/tree_html.hpp"
#include "host/page/tree_json.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double point_step_mm = 0.5, above_line_mm = 0.12;

/// Young's modulus at the peak: the travel L at which
///     theret(P, a, L) = 6 mu e^(gamma 1.3 (L / a)^2) (1 + C / 2).
double stiffness_at_peak(const SupposedTissue& tissue, double peak_kpa, double radius_mm) {
    const auto stiffness = [&](double travel_mm) {
        return 6 * tissue.mu_kpa * (1 + 0.5 * tissue.amplitude) *
               std::exp(std::min(60.0, tissue.gamma * 1.3 * std::pow(travel_mm / radius_mm, 2)));
    };
    double low = 1e-4 * radius_mm, high = 2 * radius_mm;
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        (theret_stiffness(peak_kpa, radius_mm, middle) > stiffness(middle) ? low : high) = middle;
    }
    return stiffness(low);
}

SuckedBody supposed_body(const AspirationSettings& settings, const Suction& suction) {
    const SupposedTissue& tissue = *settings.supposed;
    const double radius_mm = 0.5 * settings.hole_diameter_mm.value;
    SuckedBody body;
    body.rest = cap_surface(tissue.cap_mm, radius_mm, settings.edge_radius_mm.value);
    const double lowest_mm = settings.instrument.rim_thickness_mm + above_line_mm;
    for (std::size_t k = 0; k < body.rest.r_mm.size(); ++k)
        if (body.rest.z_mm[k] > lowest_mm) body.seen_to_mm = body.rest.r_mm[k];
    body.steps = suction_steps(suction, suction.end_s(), settings.steps);
    body.start = {tissue.mu_kpa, tissue.gamma, tissue.amplitude, tissue.relaxation_s,
                  stiffness_at_peak(tissue, suction.peak_kpa(), radius_mm)};
    return body;
}

struct SeenPoints {
    std::string csv;
    double to_mm = 0;  ///< r of the farthest
};

/// Where the supposed tissue will be seen, at the times that are solved; its heights are not used.
SeenPoints seen_points(const AspirationSettings& settings, const std::string& model,
                       const OptionValues& values, const ProgressSink& progress) {
    SimulationSettings simulation = parse_simulation(model, "the supposed tissue", {});
    take_tangent_options(values, simulation.newton);
    SimulationWish wish;
    wish.fills_cells = false;
    const SimulationResult result = run_simulation(simulation, progress, wish);
    if (!result.converged())
        throw Error(ErrorCode::solve_failed,
                    "the supposed tissue has no equilibrium under this suction; suppose a stiffer "
                    "one, or suck less");
    Selection surface;
    surface.point_array = "surface";
    const std::vector<Index> nodes = nodes_along(surface, result);
    const int bins = int(0.5 * settings.hole_diameter_mm.value / point_step_mm);
    const double lowest_mm = settings.instrument.rim_thickness_mm + above_line_mm;
    SeenPoints seen{"time_s,r_mm,z_mm,sd_mm\n"};
    std::size_t num_rows = 0;
    for (std::size_t k = 1; k < result.states.size(); ++k) {
        const SmoothCurve curve = surface_profile(result, nodes, k, bins * point_step_mm).height;
        for (int bin = -bins; bin <= bins; ++bin) {
            const double z_mm = curve.at(std::abs(bin) * point_step_mm);
            if (z_mm < lowest_mm) continue;
            seen.to_mm = std::max(seen.to_mm, bin * point_step_mm);
            seen.csv += fmt::format("{:.6g},{:g},{:.6f},{:g}\n", result.states[k].time_s,
                                    bin * point_step_mm, z_mm, settings.supposed->sd_mm);
            ++num_rows;
        }
    }
    if (num_rows < 20)
        throw Error(ErrorCode::input_unusable,
                    "the supposed tissue is hardly seen above the line of visibility; suck more, "
                    "or suppose a higher cap_mm");
    return seen;
}

/// The supposed tissue has one term: the first number of terms that has any.
int planned_terms(const AspirationSettings& settings) {
    const std::vector<int>& terms = settings.relaxation_terms;
    const auto any = std::find_if(terms.begin(), terms.end(), [](int count) { return count > 0; });
    return any == terms.end() ? 0 : *any;
}

std::string plan_page(const IdentifiedExperiment& found, const ResultTree& tree,
                      const std::string& model) {
    std::string figures;
    for (const Picture& picture : identified_pictures(found))
        figures +=
            "<figure>" + picture.html + "<figcaption>" + picture.caption + "</figcaption></figure>";
    return page_html(
        {.kind = "palpate aspirate plan",
         .version = version_text(),
         .headline = "What a film of such tissue would tell",
         .lead = fmt::format("<p class='summary'>Supposed: {}. Intervals are of the "
                             "noise that is told, of what is known with an error, and of what "
                             "fits add for what no residual shows; what the model misses of your "
                             "tissue comes on top.</p>",
                             model),
         .main = tree_sections_html(
             tree,
             section_html("profiles", "Profiles", "<div class='figures'>" + figures + "</div>")),
         .footer = "All figures: <code>result.json</code>."});
}

}  // namespace

Outcome run_plan(const OptionValues& values, const ProgressSink& progress) {
    const auto begin = std::chrono::steady_clock::now();
    if (!values.is_given("out"))
        throw Error(ErrorCode::invalid_argument, "plan writes a folder; give --out");
    const fs::path folder = values.path("out");
    check_output_folder(folder, fit_result_file, values.flag("overwrite"));
    const AspirationSettings settings =
        read_aspiration_settings(values.path("config"), AspirationPart::tissue);
    if (!settings.supposed)
        throw Error(ErrorCode::invalid_argument,
                    "there is no supposed tissue; give a table [supposed] with mu_kpa");
    const Suction suction = suction_from(values, settings);
    SuckedBody body = supposed_body(settings, suction);
    const std::string& law = settings.laws.front();
    const int num_term = planned_terms(settings);
    Outcome outcome;
    write_folder_atomically(folder, values.flag("overwrite"), [&](const fs::path& inside) {
        const SeenPoints seen =
            seen_points(settings, supposed_model_text(settings, body, suction, law, num_term),
                        values, progress);
        write_text_file(inside / points_file, seen.csv);
        body.seen_later_to_mm = seen.to_mm;
        const std::string text = experiment_text(settings, body, suction, law, num_term);
        write_text_file(inside / "experiment.toml", text);
        const Experiment experiment = tissue_experiment(text, inside);
        const ExperimentProblem problem(
            experiment,
            [&](SimulationSettings& model) { take_tangent_options(values, model.newton); },
            jobs_of(values), progress);
        const PlannedProblem planned(problem);
        IdentifiedExperiment found{.experiment = experiment, .is_plan = true};
        found.fit = fit(planned, {}, progress);
        report_progress(progress, "intervals", 0, "");
        IdentifyOptions judging;
        judging.jobs = jobs_of(values);
        judging.added_sd = model_sds(experiment.parameters());
        found.identified = identify(planned, found.fit, judging, progress);
        correct_for_discretisation({}, found.fit, found.identified, judging.added_sd);
        found.num_simulation = problem.num_simulation();
        found.seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        outcome.result = identified_tree(found);
        outcome.text = identified_text(found);
        write_text_file(inside / fit_result_file, tree_json(outcome.result));
        write_text_file(
            inside / "report.html",
            plan_page(found, outcome.result,
                      fmt::format("{}, {} relaxation term{}, mu {:g} kPa", law, num_term,
                                  num_term == 1 ? "" : "s", settings.supposed->mu_kpa)));
    });
    outcome.text += fmt::format("report: {}/report.html\n", folder.string());
    return outcome;
}

}  // namespace palpate
