// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/mechanics.hpp"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "host/apps/recover/observations/displacement_prior.hpp"
#include "host/geometry/surfaces/surface.hpp"

namespace palpate {
namespace {

constexpr double wall_smoothing_mm = 6.0;

std::vector<Unknown> unknown_moduli(const RecoveryModel& recovery, const ReducedModel& model,
                                    const PriorSettings& prior) {
    std::vector<Unknown> unknowns;
    for (const Index region : recovery.unknown) {
        if (!model.has_region(region)) continue;
        unknowns.push_back(
            {region, std::log(stiffness_kpa(recovery.model, region)), prior.stiffness_sd_ln});
    }
    return unknowns;
}

/// Outward unit normals without what is shorter than `wall_smoothing_mm`: along a crease neighbours
/// would else be expected to move in directions of their own. What faces away, as the other side
/// of a flat organ does, has no part in it.
std::vector<Vec3> smooth_normals(const Surface& surface) {
    const std::vector<Vec3> rough = vertex_normals(surface);
    std::vector<Vec3> smooth(rough.size(), Vec3::Zero());
    constexpr double reach = 3.0 * wall_smoothing_mm;
    for (std::size_t a = 0; a < rough.size(); ++a) {
        for (std::size_t b = 0; b < rough.size(); ++b) {
            const double squared = (surface.vertices[a] - surface.vertices[b]).squaredNorm();
            if (squared > reach * reach || rough[a].dot(rough[b]) <= 0) continue;
            smooth[a] +=
                std::exp(-0.5 * squared / (wall_smoothing_mm * wall_smoothing_mm)) * rough[b];
        }
        smooth[a].normalize();  // along rough[a] it has at least that of a itself
    }
    return smooth;
}

}  // namespace

WallExpectation wall_expectation(const RecoveryModel& recovery, const PriorSettings& prior) {
    WallExpectation expectation;
    expectation.sd_mm = prior.displacement_sd_mm;
    expectation.range_mm = prior.displacement_range_mm;
    std::vector<Vec3> normals(recovery.model.mesh.nodes.size(), Vec3::Zero());
    for (const ObservedSurface& organ : recovery.surfaces) {
        if (!organ.driven) continue;
        // Where two organs touch, theirs are opposite: one of them is enough.
        const std::vector<Vec3> own = smooth_normals(organ.surface);
        for (std::size_t v = 0; v < own.size(); ++v)
            if (normals[organ.node_of[v]].isZero(0)) normals[organ.node_of[v]] = own[v];
    }
    for (const Index node : recovery.driven) {
        const double length = normals[node].norm();
        expectation.places.push_back(recovery.model.mesh.nodes[node]);
        expectation.normals.push_back(length > 0 ? Vec3(normals[node] / length) : Vec3::UnitX());
    }
    return expectation;
}

Mechanics make_mechanics(RecoveryModel recovery, const PriorSettings& prior,
                         const LinearSolverOptions& solver, const MechanicsOptions& options,
                         StageTimer& timer, const ProgressSink& progress) {
    timer.start("condensing");
    CondensationSummary condensation;
    const ReducedModel reduced(condense(recovery.model, recovery.observed, recovery.driven, solver,
                                        &condensation, progress),
                               static_cast<Index>(recovery.observed.size()),
                               static_cast<Index>(recovery.driven.size()),
                               moduli_of(recovery.model));
    timer.start("compressing");
    WallPrior walls(
        displacement_precision(recovery, prior.displacement_sd_mm, prior.displacement_range_mm),
        wall_expectation(recovery, prior));
    auto unknowns = unknown_moduli(recovery, reduced, prior);
    std::vector<Index> unknown;
    for (const Unknown& modulus : unknowns) unknown.push_back(modulus.object);
    ResponseModel response =
        ResponseModel::compressed(reduced, walls, unknown, options.response, progress);
    report_progress(
        progress, "compressing", 1,
        fmt::format("{} wall motions, {} surface modes, {:.2g} mm left out",
                    response.num_functionals(), response.num_modes(), response.left_out_mm()));
    return {std::move(recovery), std::move(walls), std::move(response), std::move(unknowns),
            std::move(condensation)};
}

Mechanics make_mechanics(const BodyMesh& mesh, const Settings& settings,
                         const LinearSolverOptions& solver, const MechanicsOptions& options,
                         StageTimer& timer, const ProgressSink& progress) {
    timer.start("condensing");
    return make_mechanics(build_model(mesh, settings), settings.prior, solver, options, timer,
                          progress);
}

}  // namespace palpate
