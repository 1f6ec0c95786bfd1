// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "host/apps/recover/inverse/model_error.hpp"
#include "host/apps/recover/pipeline/finite_strain.hpp"
#include "host/apps/study/beside.hpp"
#include "host/apps/study/exact_observations.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/apps/study/tables.hpp"

namespace palpate {
namespace {

constexpr char doubled[] = "surroundings 20, assumed 10";
constexpr double assumed_kpa = 10;  // of the surrounding tissue
/// What linear elasticity leaves of such deformations, taken for noise at the start.
constexpr double linear_noise_mm = 0.5;
constexpr double smallest_noise_mm = 0.01;

struct NeoHookeanTruth {
    PelvisOptions options;
    /// The surrounding tissue is twice as stiff as assumed: half of the true stiffness is expected.
    bool is_doubled = false;
    double expected_kpa() const { return options.stiffness_kpa / (is_doubled ? 2 : 1); }
};

std::string name_of(const NeoHookeanTruth& truth) {
    return truth.is_doubled ? doubled : "surroundings known";
}

struct Outcome {
    FiniteStrainEstimate found;
    double seconds = 0;  ///< from the mesh to the answer
};

Outcome recover_neo_hookean(const NeoHookeanTruth& truth, const StudyOptions& options,
                            const ProgressSink& progress) {
    LinearSolverOptions solver = options.solver;
    solver.relative_tolerance = 1e-10;
    PelvisPhantom phantom = make_pelvis(truth.options, solver, options.mesher, progress);
    phantom.settings.background->stiffness_kpa = assumed_kpa;
    const auto begin = std::chrono::steady_clock::now();
    StageTimer timer;
    const Mechanics rest = make_mechanics(body_mesh(phantom.mesh), phantom.settings, solver,
                                          {exact_response(0.1 * linear_noise_mm)}, timer, progress);
    FiniteStrainOptions search;
    search.search = exact_search(linear_noise_mm);
    search.search.noise_iterations = 3;
    search.search.modulus_tolerance_sd = MapOptions{}.modulus_tolerance_sd;
    search.search.max_iterations = 40;
    search.search.smallest_noise_scale = smallest_noise_mm / linear_noise_mm;
    search.displacement_tolerance_mm = 0.5 * smallest_noise_mm;
    search.modulus_tolerance_sd = 0.3;
    search.model_sd_ln = 0;
    search.max_rounds = 12;
    search.tangent_tolerance_mm = 0.01;
    search.solver = solver;
    Outcome outcome;
    outcome.found = search_finite_strain(
        rest, {"neo-hookean"}, exact_observations(rest.recovery, phantom, linear_noise_mm), search,
        progress);
    outcome.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return outcome;
}

Row neo_hookean_row(const NeoHookeanTruth& truth, const StudyOptions& options,
                    const ProgressSink& progress) {
    const Outcome outcome = recover_neo_hookean(truth, options, progress);
    const MapEstimate& found = outcome.found.estimate;
    const double kpa = std::exp(found.theta[0]), expected = truth.expected_kpa();
    const double linear = std::exp(outcome.found.first.theta[0]);
    const auto& [low, high] = found.interval_kpa[0];
    Row row;
    row.set("truth", name_of(truth));
    row.set("seed", truth.options.seed, 0);
    row.set("true_kpa", truth.options.stiffness_kpa, 1);
    row.set("expected_kpa", expected, 1);
    row.set("found_kpa", kpa, 2);
    row.set("error_percent", 100 * (kpa / expected - 1), 2);
    row.set("low_kpa", low, 2);
    row.set("high_kpa", high, 2);
    row.set_flag("holds_truth", low <= expected && expected <= high);
    row.set("linear_kpa", linear, 2);
    row.set("linear_error_percent", 100 * (linear / expected - 1), 2);
    row.set_flag("converged", found.termination.converged);
    row.set("rounds", outcome.found.rounds, 0);
    row.set("seconds", outcome.seconds, 1);
    return row;
}

/// Rows with the surroundings known, or with them doubled.
std::vector<Row> rows_with(const std::vector<Row>& rows, bool is_doubled) {
    std::vector<Row> chosen;
    for (const Row& row : rows)
        if ((row.text("truth") == doubled) == is_doubled) chosen.push_back(row);
    return chosen;
}

/// One line per stiffness, one column per scene: ours, what linear elasticity makes of the same
/// surfaces, and the published ones.
StudyTable beside_table(const std::vector<Row>& rows, const std::string& key,
                        const std::vector<PublishedStiffness>& published) {
    BesideTable table(key);
    for (const char* column : {"found_kpa", "linear_kpa"})
        for (const Row& row : rows)
            table.add(
                row.number("expected_kpa"),
                (column == std::string("found_kpa") ? "neo-Hookean, seed " : "linear, seed ") +
                    row.text("seed"),
                fmt::format("{:.2f}", row.number(column)));
    for (const auto& value : published)
        table.add(value.expected_kpa, "published, " + value.scene,
                  fmt::format("{:g}", value.found_kpa));
    return table.table();
}

double largest(const std::vector<Row>& rows, const std::string& column) {
    double most = 0;
    for (const Row& row : rows)
        if (row.has(column)) most = std::max(most, std::abs(row.number(column)));
    return most;
}

std::ptrdiff_t num_unsettled(const std::vector<Row>& rows) {
    return std::ranges::count_if(rows, [](const Row& row) { return !row.flag("converged"); });
}

StudyReport neo_hookean_report(const std::vector<Row>& rows) {
    const auto known = rows_with(rows, false), twice = rows_with(rows, true);
    const StudyTable known_table = beside_table(known, "true E, kPa", published_neo_hookean());
    const StudyTable twice_table = beside_table(twice, "expected E, kPa", published_surroundings());
    const Accuracy all = accuracy_of("all", estimates_of(rows));
    StudyReport report;
    report.headline = fmt::format(
        "Neo-Hookean tissue, 50 to 200 kPa: largest error {:.1f} %; with linear elasticity, and "
        "0.5 mm of the surfaces taken for noise, {:.0f} %",
        largest(rows, "error_percent"), largest(rows, "linear_error_percent"));
    report.sentences = {
        "The truth obeys the neo-Hookean law at large deformation, on the mesh of the recovery, "
        "and "
        "targets are its exact surfaces: what is left is the search.",
        fmt::format("{} of {} intervals hold the truth. A recovery took at most {:.0f} s from mesh "
                    "to answer and {:.0f} rounds of linearisation.",
                    all.num_holding, all.num_intervals, largest(rows, "seconds"),
                    largest(rows, "rounds")),
        fmt::format("{} of {} searches did not settle and ended with their best point; the errors "
                    "include them.",
                    num_unsettled(rows), rows.size()),
        "Twice as stiff surroundings under the same motion are the known ones of half the "
        "stiffness, scaled: those rows repeat others as a check, and are no new evidence."};
    report.sections = {
        accuracy_section(estimates_of(known), estimates_of(published_neo_hookean()),
                         "true E of the prostate, kPa",
                         "Truth and recovery share mesh and law, and there are no voxels."),
        {"Recovered stiffness, kPa",
         known_table.html("beside") +
             "<p class='caption'>Linear: what linear elasticity makes of the same surfaces, with "
             "0.5 mm of them taken for noise; where the rounds begin.</p>",
         {}},
        {"Surrounding tissue twice as stiff as assumed, kPa",
         twice_table.html("beside") +
             "<p class='caption'>It truly has 20 kPa, but 10 kPa was assumed: without a measured "
             "force half of the true stiffness is the right answer.</p>",
         {}}};
    report.facts = {{"worst_error_percent", largest(known, "error_percent")},
                    {"worst_error_percent_doubled_surroundings", largest(twice, "error_percent")},
                    {"worst_error_percent_linear", largest(rows, "linear_error_percent")},
                    {"most_rounds", largest(rows, "rounds")},
                    {"longest_recovery_s", largest(rows, "seconds")},
                    {"intervals", double(all.num_intervals)},
                    {"intervals_that_hold", double(all.num_holding)}};
    report.text =
        known_table.plain() + "\nSurroundings 20 kPa, assumed 10:\n" + twice_table.plain();
    return report;
}

}  // namespace

Study make_neo_hookean_study(const StudyOptions& options) {
    Study study{"neo-hookean",
                "Recovery at large deformation",
                pelvis_settings(with_linear_truths(options)),
                {"truth", "seed", "true_kpa", "expected_kpa", "found_kpa", "error_percent",
                 "low_kpa", "high_kpa", "holds_truth", "linear_kpa", "linear_error_percent",
                 "converged", "rounds", "seconds"},
                {},
                neo_hookean_report};
    for (const bool is_doubled : {false, true})
        for (int scene = 0; scene < options.phantoms; ++scene)
            for (const double kpa : {50, 100, 150, 200}) {
                NeoHookeanTruth truth{
                    pelvis_options(options, options.first_seed + unsigned(scene), kpa), is_doubled};
                truth.options.law = {"neo-hookean"};
                truth.options.element = ElementType::tet4;
                truth.options.num_nodes = options.mesher.num_nodes;
                if (is_doubled) truth.options.background_stiffness_kpa = 2 * assumed_kpa;
                const std::string id = fmt::format(
                    "{}-seed-{}-e{:g}", is_doubled ? "doubled" : "known", truth.options.seed, kpa);
                study.cases.push_back({id, id, [truth, options](const ProgressSink& progress) {
                                           return neo_hookean_row(truth, options, progress);
                                       }});
            }
    return study;
}

}  // namespace palpate
