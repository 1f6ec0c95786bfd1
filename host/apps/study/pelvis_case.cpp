// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/pelvis_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/apps/phantom/random_numbers.hpp"
#include "host/apps/recover/pipeline/recover.hpp"
#include "host/apps/study/statistics.hpp"

namespace palpate {
namespace {

Vec3 sample(const Image<Vec3>& field, const Vec3& point) {
    const Vec3 index = field.grid.to_index(point);
    Index low[3];
    double fraction[3];
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::clamp<Index>(Index(std::floor(index[axis])), 0,
                                      std::max<Index>(0, field.grid.size[axis] - 2));
        fraction[axis] = index[axis] - double(low[axis]);
    }
    Vec3 value = Vec3::Zero();
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        Index at[3];
        for (int axis = 0; axis < 3; ++axis) {
            const int up = corner >> axis & 1;
            at[axis] = std::min(low[axis] + up, field.grid.size[axis] - 1);
            weight *= up ? fraction[axis] : 1 - fraction[axis];
        }
        value += weight * field.at(at[0], at[1], at[2]);
    }
    return value;
}

double total_seconds_of(const RecoveryResult& result) {
    double sum = 0;
    for (const auto& stage : result.timings_s) sum += stage.second;
    return sum;
}

}  // namespace

const RegionResult& PelvisOutcome::prostate() const {
    return *std::find_if(result.regions.begin(), result.regions.end(),
                         [](const RegionResult& region) { return region.unknown; });
}

std::string id_of(const PelvisCase& work) {
    std::string id = fmt::format("seed-{}-e{}", work.truth.seed, work.truth.stiffness_kpa);
    for (const auto& [name, value] : work.labels) id += fmt::format("-{}-{}", name, value);
    return id;
}

std::string title_of(const PelvisCase& work) {
    std::string title = fmt::format("seed {}, {} kPa", work.truth.seed, work.truth.stiffness_kpa);
    for (const auto& [name, value] : work.labels) title += fmt::format(", {} {}", name, value);
    std::replace(title.begin(), title.end(), '_', ' ');
    return title;
}

StudyCase study_case(const PelvisCase& work, const StudyOptions& options) {
    return {id_of(work), title_of(work), [work, options](const ProgressSink& progress) {
                return pelvis_row(work, run_pelvis_case(work, options, progress));
            }};
}

PelvisOptions pelvis_options(const StudyOptions& options, unsigned seed, double stiffness_kpa) {
    PelvisOptions truth;
    truth.seed = seed;
    truth.stiffness_kpa = stiffness_kpa;
    truth.spacing = options.spacing;
    truth.contours = drawn_for(options.contours, seed);
    truth.load = drawn_for(options.load, seed);
    truth.anatomy = drawn_for(options.anatomy, seed);
    truth.num_nodes = options.phantom_nodes;
    truth.element = options.phantom_element;
    truth.tangential_factor = options.tangential;
    return truth;
}

double drawn_stiffness_kpa(unsigned seed) {
    RandomNumbers random(0x73746966ull * 1000003ull + seed);
    const double drawn = std::exp(random.uniform(std::log(40.0), std::log(350.0)));
    return std::round(10 * drawn) / 10;
}

PelvisOutcome run_pelvis_case(const PelvisCase& work, const StudyOptions& options,
                              const ProgressSink& progress) {
    PelvisOutcome outcome;
    outcome.phantom = make_pelvis(work.truth, options.solver, options.mesher, progress);
    RecoverOptions recovery;
    recovery.settings = outcome.phantom.settings;
    if (work.assume) work.assume(recovery.settings);
    recovery.mesher = options.mesher;
    recovery.solver = options.solver;
    outcome.result = recover({outcome.phantom.reference, "reference"},
                             {outcome.phantom.target, "target"}, recovery, progress);
    return outcome;
}

std::vector<std::string> pelvis_columns() {
    return {"seed",        "true_kpa", "expected_kpa",     "found_kpa",       "error_percent",
            "low_kpa",     "high_kpa", "holds_truth",      "ln_error",        "claimed_sd",
            "contours_mm", "verdict",  "landmark_mean_mm", "landmark_max_mm", "converged",
            "iterations",  "seconds"};
}

Row pelvis_row(const PelvisCase& work, const PelvisOutcome& outcome) {
    const double expected = work.expected_kpa > 0 ? work.expected_kpa : work.truth.stiffness_kpa;
    const RegionResult& found = outcome.prostate();
    const auto& [low, high] = found.interval_kpa;
    const auto errors = landmark_errors_mm(outcome.phantom, outcome.result.displacement_field);
    Row row;
    for (const auto& [name, value] : work.labels) row.set(name, value);
    row.set("seed", work.truth.seed, 0);
    row.set("true_kpa", work.truth.stiffness_kpa, 1);
    row.set("expected_kpa", expected, 1);
    row.set("found_kpa", found.stiffness_kpa, 2);
    row.set("error_percent", 100 * (found.stiffness_kpa / expected - 1), 1);
    row.set("low_kpa", low, 2);
    row.set("high_kpa", high, 2);
    row.set_flag("holds_truth", low <= expected && expected <= high);
    row.set("ln_error", std::log(found.stiffness_kpa / expected), 3);
    row.set("claimed_sd", std::log(high / low) / (2 * 1.96), 3);
    row.set("contours_mm", outcome.result.contours ? outcome.result.contours->sd_mm : 0.0, 3);
    row.set("verdict", std::string(name_of(found.verdict)));
    row.set("landmark_mean_mm", mean_of(errors), 3);
    row.set("landmark_max_mm", *std::max_element(errors.begin(), errors.end()), 3);
    row.set_flag("converged", outcome.result.termination.converged);
    row.set("iterations", outcome.result.termination.iterations, 0);
    row.set("seconds", total_seconds_of(outcome.result), 1);
    return row;
}

StudyOptions with_linear_truths(StudyOptions options) {
    options.phantom_element = ElementType::tet4;
    return options;
}

std::vector<double> landmark_errors_mm(const PelvisPhantom& phantom, const Image<Vec3>& field) {
    std::vector<double> errors;
    for (std::size_t n = 0; n < phantom.landmarks.size(); ++n) {
        const Vec3 found = sample(field, phantom.landmarks[n]);
        errors.push_back((found - phantom.landmark_displacements[n]).norm());
    }
    return errors;
}

std::vector<std::pair<std::string, std::string>> pelvis_settings(const StudyOptions& options) {
    const char* mesher = options.mesher.kind == MesherKind::tetgen ? "tetgen"
                         : options.mesher.kind == MesherKind::cgal ? "cgal"
                                                                   : "auto";
    return {
        {"first seed", fmt::format("{}", options.first_seed)},
        {"spacing", fmt::format("{} x {} x {} mm", options.spacing[0], options.spacing[1],
                                options.spacing[2])},
        {"contours", to_text(options.contours)},
        {"load", name_of(options.load)},
        {"anatomy", name_of(options.anatomy)},
        {"nodes", fmt::format("{}", options.mesher.num_nodes)},
        {"phantom nodes", fmt::format("{}", options.phantom_nodes)},
        {"phantom element", element_table(options.phantom_element).name},
        {"tangential factor", fmt::format("{}", options.tangential)},
        {"mesher", mesher},
        {"precision", options.solver.device.precision == Precision::single ? "single" : "double"},
        {"linear solver", name_of(options.solver.method)}};
}

}  // namespace palpate
