// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/pipeline/recover.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include "host/imaging/io.hpp"
#include "host/meshing/io.hpp"
#include "host/modelling/regions.hpp"
#include "host/objectives/surface_observations.hpp"
#include "host/pipeline/finish.hpp"
#include "host/pipeline/mechanics.hpp"
#include "host/pipeline/stages.hpp"
#include "host/pipeline/states.hpp"

namespace palpate {
namespace {

RegionMesh mesh_of(const RecoverOptions& options, const ReferenceState& reference,
                   MesherSummary& summary, const ProgressSink& progress) {
    const Settings& settings = options.settings;
    if (options.mesh.empty()) {
        MesherOptions mesher = options.mesher;
        mesher.edge_length_mm = reference.edge_length_mm;
        mesher.outer_edge_length_mm = 4.0 * reference.edge_length_mm;
        return make_mesh(reference.surface, reference.state.regions, reference.state.field,
                         hollow_regions(settings), mesher, &summary, progress);
    }
    const Mesh mesh =
        with_region_numbers(read_vtu(options.mesh), settings, options.mesh.filename().string());
    summary.mesher = "ready mesh";
    summary.quality = mesh_quality(mesh, settings.num_regions());
    return region_mesh_from_tets(mesh, reference.state.field, settings);
}

/// The reference with all that is done once, however many targets there are.
struct Prepared {
    ReferenceState reference;
    RegionMesh mesh;
    MesherSummary mesher;
    Mechanics mechanics;
    std::vector<DistanceMap> maps;
};

Prepared prepare(ReferenceState reference, const RecoverOptions& options, StageTimer& timer,
                 const ProgressSink& progress) {
    timer.start("meshing");
    auto maps = std::async(std::launch::async, [&] {
        return maps_of_matched(reference.state.field, options.settings);
    });
    MesherSummary mesher;
    RegionMesh mesh = mesh_of(options, reference, mesher, progress);
    report_progress(
        progress, "meshing", 1,
        fmt::format("{}: {} nodes, {} elements, smallest dihedral angle {:.1f} deg", mesher.mesher,
                    mesh.mesh.num_nodes(), mesh.mesh.num_tets(), mesher.quality.min_dihedral_deg));
    timer.start("condensing");
    Mechanics mechanics = make_mechanics(mesh, options.settings, options.solver, progress);
    auto reference_maps = maps.get();
    return {std::move(reference), std::move(mesh), std::move(mesher), std::move(mechanics),
            std::move(reference_maps)};
}

std::vector<std::uint8_t> seen_nodes(const Mesh& mesh, const LabelField& target,
                                     const RigidTransform& reference_to_target) {
    std::vector<std::uint8_t> seen(mesh.nodes.size());
    std::transform(mesh.nodes.begin(), mesh.nodes.end(), seen.begin(), [&](const Vec3& node) {
        return target.inside_box(reference_to_target.apply(node));
    });
    return seen;
}

ObservedMaps observed_maps(const Prepared& prepared, const TargetState& target,
                           const Settings& settings) {
    ObservedMaps maps;
    maps.reference = prepared.maps;
    const RigidTransform back = target.alignment.reference_to_target.inverse();
    for (const auto& map : maps_of_matched(target.state.field, settings)) {
        maps.target.push_back(map.moved(back));
    }
    return maps;
}

ObservationOptions observation_options(const Settings& settings, const ImageGrid& reference,
                                       const ImageGrid& target) {
    const double voxel = std::cbrt(std::max(reference.voxel_volume(), target.voxel_volume()));
    ObservationOptions options;
    options.noise_mm = settings.prior.noise_voxels * voxel;
    options.correlation_area_mm2 = 7.0 * voxel * voxel;
    return options;
}

RecoveryResult recover_target(const Prepared& prepared, const TargetState& target,
                              const RecoverOptions& options, StageTimer timer,
                              const ProgressSink& progress) {
    const Settings& settings = options.settings;
    const Mechanics& mechanics = prepared.mechanics;
    Recovered found;
    found.alignment = target.alignment;
    found.mesh = prepared.mesh;
    found.mesher = prepared.mesher;
    found.recovery = mechanics.recovery;

    timer.start("distances");
    found.maps = observed_maps(prepared, target, settings);
    const LabelledState& reference = prepared.reference.state;
    const SurfaceObservations observations(
        found.recovery, found.maps,
        seen_nodes(found.mesh.mesh, target.state.field, target.alignment.reference_to_target),
        observation_options(settings, reference.regions.grid, target.state.regions.grid));

    timer.start("searching");
    found.estimate = map_estimate(mechanics.response, mechanics.walls, observations,
                                  mechanics.priors, options.search, progress);

    timer.start("solving");
    solve_full_model(found, options.solver, progress);

    timer.start("volumes");
    report_progress(progress, "volumes", 0, "carrying labels and field to the image grids");
    RecoveryResult result = assemble_result(found, reference.regions, reference.field,
                                            target.state.regions, target.state.field, settings);
    timer.stop();
    result.reference_name = reference.name;
    result.target_name = target.state.name;
    result.linear_solvers = {{"condensing", mechanics.condensation.solver},
                             {"solving", found.solver}};
    result.timings_s = timer.times_s();
    return result;
}

}  // namespace

Segmentation read_segmentation(const std::filesystem::path& path) {
    return {read_label_image(path), path.filename().string()};
}

void recover_all(const Segmentation& reference, const std::vector<Segmentation>& targets,
                 const RecoverOptions& options, const ResultSink& sink,
                 const ProgressSink& progress) {
    const Settings& settings = options.settings;
    StageTimer timer;
    timer.start("reading");
    report_progress(progress, "reading", 0, "smoothing the segmentations");
    auto reading = std::async(std::launch::async, [&] {
        std::vector<LabelledState> states;
        for (const auto& target : targets) states.push_back(make_state(target, settings));
        return states;
    });
    LabelledState reference_state = make_state(reference, settings);
    std::vector<LabelledState> target_states = reading.get();

    timer.start("surfaces");
    ReferenceState state = make_reference(std::move(reference_state), options, progress);

    timer.start("aligning");
    std::vector<TargetState> aligned;
    for (auto& target : target_states) {
        aligned.push_back(align_target(std::move(target), state, options, progress));
    }

    const Prepared prepared = prepare(std::move(state), options, timer, progress);
    for (std::size_t k = 0; k < aligned.size(); ++k) {
        sink(k, recover_target(prepared, aligned[k], options, timer, progress));
    }
}

RecoveryResult recover(const Segmentation& reference, const Segmentation& target,
                       const RecoverOptions& options, const ProgressSink& progress) {
    RecoveryResult only;
    recover_all(
        reference, {target}, options,
        [&](std::size_t, RecoveryResult result) { only = std::move(result); }, progress);
    return only;
}

}  // namespace palpate
