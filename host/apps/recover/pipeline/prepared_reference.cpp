// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/prepared_reference.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <future>
#include <utility>

#include "host/apps/recover/modelling/regions.hpp"
#include "host/geometry/meshing/solid_mesh_file.hpp"
#include "solver/model/quadratic_mesh.hpp"

namespace palpate {
namespace {

/// A finer mesh has eight times as many: beyond this it takes longer than the search, and changes
/// hundredths of a millimetre.
constexpr Index most_nodes_to_refine = 30000;

BodyMesh mesh_of(const RecoverOptions& options, const ReferenceState& reference,
                 MesherSummary& summary, const ProgressSink& progress) {
    const Settings& settings = options.settings;
    if (options.mesh.empty()) {
        MesherOptions mesher = options.mesher;
        if (options.element == ElementType::tet10) mesher.num_nodes /= quadratic_nodes_per_corner;
        mesher.edge_length_mm = reference.edge_length_mm;
        mesher.outer_edge_length_mm = 4.0 * reference.edge_length_mm;
        return body_mesh(
            make_mesh(reference.surface, reference.state.regions, reference.state.field,
                      hollow_regions(settings), mesher, &summary, progress),
            options.element);
    }
    SolidMesh mesh =
        with_region_numbers(read_solid_mesh(options.mesh, Formulation::solid, "region").mesh,
                            settings, options.mesh.filename().string());
    summary.mesher = "ready mesh";
    summary.quality = mesh_quality(corner_mesh_of(mesh), settings.num_regions());
    return body_mesh(std::move(mesh), reference.state.field, settings, options.element);
}

}  // namespace

PreparedReference prepare_reference(ReferenceState reference, const RecoverOptions& options,
                                    StageTimer& timer, const ProgressSink& progress) {
    timer.start("meshing");
    auto maps = std::async(std::launch::async, [&] {
        return maps_of_matched(reference.state.field, options.settings, own_margin_mm);
    });
    MesherSummary mesher;
    BodyMesh mesh = mesh_of(options, reference, mesher, progress);
    report_progress(progress, "meshing", 1,
                    fmt::format("{}: {} nodes, {} {} elements, smallest dihedral angle {:.1f} deg",
                                mesher.mesher, mesh.mesh.num_nodes(), mesh.mesh.num_elements(),
                                mesh.mesh.table().name, mesher.quality.min_dihedral_deg));
    auto done = maps.get();
    return prepare_reference(std::move(reference), std::move(mesh), std::move(mesher),
                             std::move(done), options, timer, progress);
}

PreparedReference prepare_reference(ReferenceState reference, BodyMesh mesh, MesherSummary mesher,
                                    std::vector<DistanceMap> maps, const RecoverOptions& options,
                                    StageTimer& timer, const ProgressSink& progress) {
    Mechanics mechanics =
        make_mechanics(mesh, options.settings, options.solver, options.mechanics, timer, progress);
    auto full_solver = start_full_solver(mechanics.recovery, options);
    auto finer_mesh = make_finer_mesh(mesh, options);
    return {std::move(reference), std::move(mesh),        std::move(mesher),    std::move(maps),
            std::move(mechanics), std::move(full_solver), std::move(finer_mesh)};
}

std::shared_ptr<FinerMesh> make_finer_mesh(const BodyMesh& mesh, const RecoverOptions& options) {
    const bool is_counted = options.method == SearchMethod::map && options.law.is_linear() &&
                            !options.settings.has_unknown_poisson_ratio();
    if (!is_counted || mesh.mesh.type != ElementType::tet4 ||
        mesh.mesh.num_nodes() > most_nodes_to_refine)
        return nullptr;
    return std::make_shared<FinerMesh>(mesh, options.settings, options.solver);
}

std::shared_ptr<FullSolver> start_full_solver(const RecoveryModel& recovery,
                                              const RecoverOptions& options) {
    const auto driven = std::count_if(recovery.surfaces.begin(), recovery.surfaces.end(),
                                      [](const auto& surface) { return surface.driven; });
    // The motion, and the gradients of the resultant force on each driven organ.
    return std::make_shared<FullSolver>(
        recovery.model, options.solver, static_cast<Index>(1 + 3 * driven),
        options.law.is_linear() ? std::launch::async : std::launch::deferred);
}

}  // namespace palpate
