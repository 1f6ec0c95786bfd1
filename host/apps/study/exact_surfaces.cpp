// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "host/apps/recover/inverse/model_error.hpp"
#include "host/apps/recover/pipeline/mechanics.hpp"
#include "host/apps/study/beside.hpp"
#include "host/apps/study/exact_observations.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/apps/study/tables.hpp"
#include "host/page/numbers.hpp"

namespace palpate {
namespace {

constexpr double first_noise_mm = 0.02;

struct Truth {
    bool is_finer = false;  ///< solved on a mesh with half the edge length of the inverse's
    PelvisOptions options;
};

std::string name_of(const Truth& truth) { return truth.is_finer ? "finer" : "same"; }

RegionMesh inverse_mesh(const Truth& truth, const PelvisPhantom& phantom,
                        const StudyOptions& options) {
    if (!truth.is_finer) return phantom.mesh;
    PelvisOptions coarse = truth.options;
    coarse.num_nodes = options.mesher.num_nodes;
    return make_pelvis_mesh(coarse, options.mesher);
}

MapEstimate recover_from_surfaces(const Truth& truth, const StudyOptions& options,
                                  const ProgressSink& progress) {
    LinearSolverOptions solver = options.solver;
    solver.relative_tolerance = 1e-10;
    const PelvisPhantom phantom = make_pelvis(truth.options, solver, options.mesher, progress);
    const RegionMesh mesh = inverse_mesh(truth, phantom, options);
    const MechanicsOptions exact{exact_response(truth.is_finer ? 0.02 : 0.002)};
    StageTimer timer;
    const Mechanics mechanics =
        make_mechanics(body_mesh(mesh), phantom.settings, solver, exact, timer, progress);
    const SurfaceObservations observations =
        exact_observations(mechanics.recovery, phantom, first_noise_mm);
    return map_estimate(mechanics.response, mechanics.walls, observations, mechanics.unknowns,
                        exact_search(first_noise_mm), progress);
}

Row row_of(const Truth& truth, const StudyOptions& options, const ProgressSink& progress) {
    const auto begin = std::chrono::steady_clock::now();
    const MapEstimate found = recover_from_surfaces(truth, options, progress);
    const double expected = truth.options.stiffness_kpa;
    KnownModulus known{std::exp(found.theta[0]), found.interval_kpa[0],
                       std::sqrt(found.covariance(0, 0))};
    if (truth.is_finer) {
        const double model_sd = model_sd_ln_with(0);
        const auto [mean, covariance] = believed_moduli(
            found.theta, found.covariance, found.unknown, Eigen::VectorXd::Constant(1, model_sd));
        known = with_model_error(known, std::exp(mean[0]), found.unknown[0].sd, model_sd);
    }
    const auto& [kpa, interval, sd_ln] = known;
    Row row;
    row.set("truth", name_of(truth));
    row.set("seed", truth.options.seed, 0);
    row.set("true_kpa", expected, 1);
    row.set("expected_kpa", expected, 1);
    row.set("found_kpa", kpa, 2);
    row.set("error_percent", 100 * (kpa / expected - 1), 2);
    row.set("low_kpa", interval[0], 2);
    row.set("high_kpa", interval[1], 2);
    row.set_flag("holds_truth", interval[0] <= expected && expected <= interval[1]);
    row.set_flag("converged", found.termination.converged);
    row.set("iterations", found.termination.iterations, 0);
    row.set("seconds",
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 1);
    return row;
}

/// One line per true stiffness, one column per scene and mesh.
StudyTable error_table(const std::vector<Row>& rows) {
    BesideTable table("true E, kPa");
    for (const Row& row : rows)
        table.add(row.number("true_kpa"),
                  "palpate, " + row.text("truth") + " mesh, seed " + row.text("seed"),
                  significant(row.number("found_kpa")));
    for (const auto& value : published_recovery())
        table.add(value.expected_kpa, "published, " + value.scene, significant(value.found_kpa));
    return table.table();
}

double worst_error(const std::vector<Row>& rows, const std::string& truth) {
    double worst = 0;
    for (const Row& row : rows)
        if (row.text("truth") == truth)
            worst = std::max(worst, std::abs(row.number("error_percent")));
    return worst;
}

StudyReport exact_surfaces_report(const std::vector<Row>& rows) {
    const auto ours = estimates_of(rows), published = estimates_of(published_recovery());
    StudyReport report;
    report.headline = fmt::format(
        "Largest error {:.1f} % with the truth on the same mesh, {:.1f} % on a twice finer one",
        worst_error(rows, "same"), worst_error(rows, "finer"));
    report.sentences = {
        "Targets are the exact surfaces of the deformed truth, without voxels: what is left is the "
        "search and the mesh. On the same mesh the answer is known to be exact; a truth on a mesh "
        "with half the edge length adds the error of linear tetrahedra."};
    report.sections = {accuracy_section(ours, published, "true E of the prostate, kPa"),
                       {"Recovered stiffness, kPa", error_table(rows).html("beside"), {}}};
    report.facts = {{"worst_error_percent_same_mesh", worst_error(rows, "same")},
                    {"worst_error_percent_finer_mesh", worst_error(rows, "finer")}};
    report.text = error_table(rows).plain();
    return report;
}

}  // namespace

Study make_exact_surfaces_study(const StudyOptions& options) {
    Study study{"exact-surfaces",
                "Recovery from exact surfaces",
                pelvis_settings(with_linear_truths(options)),
                {"truth", "seed", "true_kpa", "expected_kpa", "found_kpa", "error_percent",
                 "low_kpa", "high_kpa", "holds_truth", "converged", "iterations", "seconds"},
                {},
                exact_surfaces_report};
    for (const bool is_finer : {false, true})
        for (int scene = 0; scene < options.phantoms; ++scene)
            for (const double kpa : {50, 100, 150, 200, 250, 300, 350}) {
                Truth truth{is_finer,
                            pelvis_options(options, options.first_seed + unsigned(scene), kpa)};
                truth.options.element = ElementType::tet4;
                truth.options.num_nodes = options.mesher.num_nodes * (is_finer ? 8 : 1);
                const std::string id =
                    fmt::format("{}-seed-{}-e{:g}", name_of(truth), truth.options.seed, kpa);
                study.cases.push_back({id, id, [truth, options](const ProgressSink& progress) {
                                           return row_of(truth, options, progress);
                                       }});
            }
    return study;
}

}  // namespace palpate
