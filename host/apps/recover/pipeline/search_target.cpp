// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/search_target.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "host/apps/recover/pipeline/full_model.hpp"
#include "solver/base/error.hpp"
#include "solver/model/node_rows.hpp"

namespace palpate {
namespace {

/// Of u_h/2 - u_h: errors fall as h^2, so that u_0 - u_h is 1 + 1/4 + 1/16 + ... of it.
constexpr double of_no_size = 4.0 / 3.0;

std::vector<std::uint8_t> seen_nodes(const SolidMesh& mesh, const TargetState& target) {
    std::vector<std::uint8_t> seen(mesh.nodes.size());
    std::transform(mesh.nodes.begin(), mesh.nodes.end(), seen.begin(),
                   [&](const Vec3& node) { return in_field_of_view(target, node); });
    return seen;
}

/// `prepared` must outlive the shapes.
ObservedShapes observed_shapes(const PreparedReference& prepared, const Recovered& found) {
    ObservedShapes shapes;
    for (const auto& map : prepared.maps) {
        shapes.reference.emplace_back(std::shared_ptr<void>(), &map);
    }
    shapes.target = found.target;
    return shapes;
}

void check_anything_seen(const SurfaceObservations& observations, const RecoveryModel& recovery) {
    const auto at_rest = [](const std::vector<Index>& nodes) {
        return Eigen::VectorXd::Zero(3 * static_cast<Index>(nodes.size()));
    };
    const auto state = observations.evaluate(at_rest(recovery.driven), at_rest(recovery.observed));
    if (std::any_of(state.seen.begin(), state.seen.end(), [](auto seen) { return seen != 0; })) {
        return;
    }
    throw Error(ErrorCode::input_unusable,
                "the target shows nothing of any organ's surface: no point of the reference lies "
                "over it and faces as it does; check its frame, or give --initial-transform");
}

/// What the published method finds, without covariance, intervals or profiles.
MapEstimate nested_estimate(const RecoveryModel& recovery, const SurfaceObservations& observations,
                            const RecoverOptions& options, const ProgressSink& progress) {
    const NestedEstimate found = nested_lbfgs(recovery, observations, options.nested, progress);
    const auto& prior = options.settings.prior;
    MapEstimate estimate;
    estimate.driven = at_nodes(found.displacement, recovery.driven);
    estimate.observed = at_nodes(found.displacement, recovery.observed);
    for (const Index region : found.unknown) {
        estimate.unknown.push_back(
            {region, std::log(prior_median_kpa(options.settings)), prior.stiffness_sd_ln});
    }
    estimate.theta = found.theta;
    estimate.records = found.records;
    estimate.termination = found.termination;
    return estimate;
}

/// The alignment and the target's shapes as the search moved them: what is at x in the reference
/// frame was seen at `motion`(x).
void move_frame(const RigidTransform& motion, Recovered& found) {
    RigidTransform& transform = found.alignment.reference_to_target;
    found.alignment.moved_mm = found.estimate.frame.tail<3>().norm();
    found.alignment.turned_deg =
        found.estimate.frame.head<3>().norm() / TargetFrame::radius_mm * 180 / std::numbers::pi;
    transform = {transform.rotation * motion.rotation, transform.apply(motion.translation)};
    for (auto& shape : found.target)
        shape = std::make_shared<DistanceMap>(
            dynamic_cast<const DistanceMap&>(*shape).moved(motion.inverse()));
}

/// u of the full model, mm, with the walls and the moduli of the estimate.
Eigen::VectorXd full_displacement(const RecoveryModel& recovery, const MapEstimate& estimate,
                                  LinearSolver& solver, const ProgressSink& progress) {
    Columns walls = Columns::Zero(recovery.model.num_dofs(), 1), displacement;
    for (std::size_t k = 0; k < recovery.driven.size(); ++k)
        walls.middleRows<3>(3 * recovery.driven[k]) =
            estimate.driven.segment<3>(3 * static_cast<Index>(k));
    const LinearSolverSummary summary =
        solver.solve(walls, displacement, [&](const Progress&) { check_cancelled(progress); });
    if (!summary.converged) throw Error(ErrorCode::solve_failed, summary.message);
    return displacement.col(0);
}

/// Both searches as one.
void add_records(const MapEstimate& earlier, MapEstimate& estimate) {
    std::vector<IterationRecord> records = earlier.records;
    append_records(records, estimate.records);
    estimate.records = std::move(records);
    if (!earlier.termination.converged) estimate.termination = earlier.termination;
    estimate.termination.iterations = static_cast<int>(estimate.records.size());
}

/// Adds to every answer of the mesh what elements of no size would change of the one at the
/// estimate, and searches on from there (method.md, 4.6).
void search_with_mesh_change(Recovered& found, const Mechanics& mechanics, FullSolver& full_solver,
                             const FinerMesh& finer_mesh, const SurfaceObservations& observations,
                             const MapOptions& options, const ProgressSink& progress) {
    std::vector<Index> unknown;
    for (const Unknown& modulus : mechanics.unknowns) unknown.push_back(modulus.object);
    const auto kpa = mechanics.response.moduli(unknown, found.estimate.theta);
    report_progress(progress, "searching", -1, "the same on a finer mesh");
    try {
        const Eigen::VectorXd displacement =
            full_displacement(found.recovery, found.estimate, full_solver.at(kpa), progress);
        found.mesh_change = of_no_size * at_nodes(finer_mesh.change(kpa, displacement, progress),
                                                  found.recovery.observed);
    } catch (const Error& error) {
        // A device that breaks while it works is an error wherever it does.
        for (const ErrorCode code : {ErrorCode::cancelled, ErrorCode::time_limit,
                                     ErrorCode::device_failed, ErrorCode::internal})
            if (error.code() == code) throw;
        found.warnings.push_back(
            std::string("What the size of the elements changes is not in the answer: ") +
            error.what());
        return;
    }
    const auto changed =
        std::make_shared<ResponseModel>(mechanics.response.shifted_by(found.mesh_change));
    const MapEstimate earlier = std::move(found.estimate);
    found.estimate = map_estimate_near(earlier, *changed, mechanics.walls, observations,
                                       mechanics.unknowns, options, progress);
    if (!found.estimate.response) found.estimate.response = changed;
    found.estimate.mesh_change_ln = found.estimate.theta - earlier.theta;
    add_records(earlier, found.estimate);
}

FiniteStrainOptions finite_strain_options(const RecoverOptions& options) {
    FiniteStrainOptions finite;
    finite.max_rounds = options.max_rounds;
    finite.tangent_tolerance_mm = options.mechanics.response.tolerance_mm;
    finite.search = options.search;
    finite.solver = options.solver;
    return finite;
}

}  // namespace

Recovered search_target(const PreparedReference& prepared, const TargetState& target,
                        std::future<TargetShapes> shapes, const RecoverOptions& options,
                        StageTimer& timer, const ProgressSink& progress) {
    const Mechanics& mechanics = prepared.mechanics;
    Recovered found;
    found.alignment = target.alignment;
    found.mesher = prepared.mesher;
    found.recovery = mechanics.recovery;

    timer.start("distances");
    found.target = shapes.get();
    ObservationOptions seen =
        observation_options(options.settings, prepared.reference.state, target);
    // The published search needs exact gradients.
    seen.over_patches = options.method != SearchMethod::nested_lbfgs;
    const SurfaceObservations observations(found.recovery, observed_shapes(prepared, found),
                                           seen_nodes(found.recovery.model.mesh, target), seen);
    check_anything_seen(observations, found.recovery);
    RecoverOptions with_contours = options;
    if (const auto& sd_mm = options.settings.prior.contour_sd_mm)
        with_contours.search.contour_mm = *sd_mm * contour_images(target);
    if (const auto by_slice = options.settings.prior.drawn_by_slice)
        with_contours.search.slice_share = *by_slice ? 1.0 : 0.0;
    search_model(found, mechanics, *prepared.full_solver, prepared.finer_mesh.get(), observations,
                 with_contours, timer, progress);
    if (!found.estimate.frame.isZero(0))
        move_frame(observations.frame_evidence().frame.transform(found.estimate.frame), found);
    return found;
}

void search_model(Recovered& found, const Mechanics& mechanics, FullSolver& full_solver,
                  const FinerMesh* finer_mesh, const SurfaceObservations& observations,
                  const RecoverOptions& options, StageTimer& timer, const ProgressSink& progress) {
    timer.start("searching");
    const bool has_unknown_ratio = !mechanics.recovery.unknown_ratio.empty();
    if (has_unknown_ratio) {
        found.poisson = search_poisson_ratios(mechanics, observations, options, progress);
        found.estimate = std::move(found.poisson->estimate);
        found.recovery = found.poisson->mechanics->recovery;
    } else if (!options.law.is_linear()) {
        found.law = options.law;
        found.finite = search_finite_strain(mechanics, options.law, observations,
                                            finite_strain_options(options), progress);
        found.estimate = std::move(found.finite->estimate);
    } else if (options.method == SearchMethod::nested_lbfgs) {
        found.estimate = nested_estimate(found.recovery, observations, options, progress);
    } else {
        found.estimate = map_estimate(mechanics.response, mechanics.walls, observations,
                                      mechanics.unknowns, options.search, progress);
        std::vector<std::shared_ptr<const MapEstimate>> others;
        if (options.looks_elsewhere && mechanics.unknowns.size() > 1 && found.estimate.walls)
            others = other_ends(found.estimate, mechanics.response, mechanics.walls, observations,
                                mechanics.unknowns, options.search, progress);
        if (finer_mesh && !mechanics.unknowns.empty())
            search_with_mesh_change(found, mechanics, full_solver, *finer_mesh, observations,
                                    options.search, progress);
        found.estimate.others = std::move(others);
    }
    found.estimate.noise.reset();  // it points into the observations, which end with the search
    timer.start("solving");
    if (found.finite) {
        take_equilibrium(found);
    } else if (has_unknown_ratio) {
        solve_full_model(found, *start_full_solver(found.recovery, options), progress);
    } else {
        solve_full_model(found, full_solver, progress);
    }
}

}  // namespace palpate
