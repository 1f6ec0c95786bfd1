// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "host/inverse/uncertainty.hpp"
#include "host/pipeline/finite_strain.hpp"
#include "host/report/findings.hpp"
#include "host/study/beside.hpp"
#include "host/study/exact_observations.hpp"
#include "host/study/pelvis_case.hpp"
#include "host/study/tables.hpp"

namespace palpate {
namespace {

constexpr double assumed_kpa = 10;  // of the surrounding tissue
/// What linear elasticity leaves of such deformations: the noise at the start.
constexpr double first_noise_mm = 0.5;
constexpr double least_noise_mm = 0.01;

struct Truth {
    PelvisOptions options;
    /// The surrounding tissue is twice as stiff as assumed: half of the true stiffness is expected.
    bool is_doubled = false;
    double expected_kpa() const { return options.stiffness_kpa / (is_doubled ? 2 : 1); }
};

std::string name_of(const Truth& truth) {
    return truth.is_doubled ? "surroundings 20, assumed 10" : "surroundings known";
}

struct Outcome {
    FiniteStrainEstimate found;
    double largest_strain = 0;
    double seconds = 0;  ///< from the mesh to the answer
};

Outcome recover_from_surfaces(const Truth& truth, const StudyOptions& options,
                              const ProgressSink& progress) {
    LinearSolverOptions solver = options.solver;
    solver.relative_tolerance = 1e-10;
    PelvisPhantom phantom = make_pelvis(truth.options, solver, options.mesher, progress);
    phantom.settings.background->stiffness_kpa = assumed_kpa;
    const auto begin = std::chrono::steady_clock::now();
    StageTimer timer;
    const Mechanics rest = make_mechanics(phantom.mesh, phantom.settings, solver,
                                          {exact_response(0.1 * first_noise_mm)}, timer, progress);
    FiniteStrainOptions search;
    search.search = exact_search(first_noise_mm);
    search.search.noise_iterations = 3;
    search.search.smallest_noise_scale = least_noise_mm / first_noise_mm;
    search.displacement_tolerance_mm = 0.5 * least_noise_mm;
    search.modulus_tolerance_sd = 0.3;
    search.model_sd_ln = 0;
    search.max_rounds = 12;
    search.response = exact_response(0.002);
    search.solver = solver;
    Outcome outcome;
    outcome.found = search_finite_strain(rest, TissueLaw::neo_hookean,
                                         exact_observations(rest.recovery, phantom, first_noise_mm),
                                         search, progress);
    outcome.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return outcome;
}

Row row_of(const Truth& truth, const StudyOptions& options, const ProgressSink& progress) {
    const Outcome outcome = recover_from_surfaces(truth, options, progress);
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

StudyReport report_of(const std::vector<Row>& rows) {
    StudyReport report;
    report.headline = "x";
    return report;
}

}  // namespace

Study make_neo_hookean_study(const StudyOptions& options) {
    Study study{"neo-hookean",
                "Recovery at large deformation",
                pelvis_settings(options),
                {"truth", "seed", "true_kpa", "expected_kpa", "found_kpa", "error_percent",
                 "low_kpa", "high_kpa", "holds_truth", "linear_kpa", "linear_error_percent",
                 "converged", "rounds", "seconds"},
                {},
                report_of};
    for (const bool is_doubled : {false, true})
        for (int scene = 0; scene < options.phantoms; ++scene)
            for (const double kpa : {50, 100, 150, 200}) {
                Truth truth{pelvis_options(options, options.first_seed + unsigned(scene), kpa),
                            is_doubled};
                truth.options.law = TissueLaw::neo_hookean;
                truth.options.num_nodes = options.mesher.num_nodes;
                if (is_doubled) truth.options.background_stiffness_kpa = 2 * assumed_kpa;
                const std::string id = fmt::format(
                    "{}-seed-{}-e{:g}", is_doubled ? "doubled" : "known", truth.options.seed, kpa);
                study.cases.push_back({id, id, [truth, options](const ProgressSink& progress) {
                                           return row_of(truth, options, progress);
                                       }});
            }
    return study;
}

}  // namespace palpate
