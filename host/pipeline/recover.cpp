// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/pipeline/recover.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <future>

#include "host/imaging/io.hpp"
#include "host/inverse/identifiability.hpp"
#include "host/meshing/io.hpp"
#include "host/meshing/rasterise.hpp"
#include "host/modelling/build_model.hpp"
#include "host/modelling/regions.hpp"
#include "host/objectives/displacement_prior.hpp"
#include "host/objectives/surface_observations.hpp"
#include "host/pipeline/finish.hpp"
#include "host/pipeline/stages.hpp"
#include "host/pipeline/volumes.hpp"
#include "host/surfaces/extract.hpp"
#include "solver/base/error.hpp"
#include "solver/condense/condensation.hpp"

namespace palpate {
namespace {

/// One segmentation, ready to be measured against.
struct LabelledState {
    RegionImage regions;
    LabelField field;
};

LabelledState read_state(const std::filesystem::path& path, const Settings& settings) {
    RegionImage regions = to_regions(read_label_image(path), settings, path.filename().string());
    LabelField field(regions, settings.num_regions());
    return {std::move(regions), std::move(field)};
}

/// Distance maps of the organs with the given role(s), in settings order.
template <typename Wanted>
std::vector<DistanceMap> maps_of(const LabelField& field, const Settings& settings,
                                 const Wanted& wanted) {
    std::vector<std::future<DistanceMap>> maps;
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (!wanted(settings.organs[k])) continue;
        const Index region = first_organ_region + static_cast<Index>(k);
        maps.push_back(std::async(std::launch::async,
                                  [&field, region] { return DistanceMap(field, region); }));
    }
    std::vector<DistanceMap> done;
    for (auto& map : maps) done.push_back(map.get());
    return done;
}

bool is_fixed(const OrganSettings& organ) { return organ.role == Role::fixed; }
bool is_matched(const OrganSettings& organ) { return organ.role != Role::fixed; }

AlignMethod method_for(const RecoverOptions& options) {
    if (!options.initial_transform.empty()) return AlignMethod::transform;
    if (options.align != AlignMethod::automatic) return options.align;
    const auto& organs = options.settings.organs;
    return std::any_of(organs.begin(), organs.end(), is_fixed) ? AlignMethod::fixed
                                                               : AlignMethod::centroid;
}

/// Surface points of the fixed organs, caps left out.
std::vector<std::vector<Vec3>> fixed_points(const RegionSurface& surface,
                                            const Settings& settings) {
    std::vector<std::vector<Vec3>> points;
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (!is_fixed(settings.organs[k])) continue;
        const Index region = first_organ_region + static_cast<Index>(k);
        points.push_back(surface_of_region(surface, region, false).vertices);
    }
    return points;
}

AlignmentResult align(const RecoverOptions& options, const LabelledState& reference,
                      const LabelledState& target, const RegionSurface& surface) {
    switch (method_for(options)) {
        case AlignMethod::transform:
            return {"transform", read_rigid_transform(options.initial_transform), 0};
        case AlignMethod::none:
            return {"none", {}, 0};
        case AlignMethod::fixed:
            return align_surfaces(fixed_points(surface, options.settings),
                                  maps_of(target.field, options.settings, is_fixed), {});
        default:
            return {"centroid",
                    align_centroids(reference.regions, target.regions, options.settings), 0};
    }
}

void check_overlap(const LabelledState& reference, const LabelledState& target,
                   const AlignmentResult& alignment, const Settings& settings) {
    const auto carried =
        carry_regions(reference.field, {}, alignment.reference_to_target, target.regions.grid);
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        const Index region = first_organ_region + static_cast<Index>(k);
        if (!is_matched(settings.organs[k]) || dice(carried, target.regions, region) > 0) continue;
        throw Error(ErrorCode::input_unusable,
                    fmt::format("organ '{}' does not overlap between reference and target after "
                                "alignment ('{}'); check that both show the same patient in one "
                                "frame, or give --initial-transform or --align centroid",
                                settings.organs[k].name, alignment.method));
    }
}

/// Edge length that puts about a third of the wanted nodes on organ surfaces.
double edge_length_for(const RegionImage& image, Index num_nodes) {
    const auto& size = image.grid.size;
    const Vec3& h = image.grid.spacing;
    const std::array<double, 3> face{h[1] * h[2], h[0] * h[2], h[0] * h[1]};
    double area = 0;
    for (Index k = 1; k < size[2]; ++k) {
        for (Index j = 1; j < size[1]; ++j) {
            for (Index i = 1; i < size[0]; ++i) {
                const auto here = image.at(i, j, k);
                area += face[0] * (here != image.at(i - 1, j, k)) +
                        face[1] * (here != image.at(i, j - 1, k)) +
                        face[2] * (here != image.at(i, j, k - 1));
            }
        }
    }
    const double smooth_area = area / 1.5;  // voxel faces overrate a sphere by 3/2
    return std::sqrt(smooth_area / (0.866 * 0.35 * num_nodes));
}

RegionMesh mesh_of(const RecoverOptions& options, const LabelledState& reference,
                   const RegionSurface& surface, double edge_length_mm, MesherSummary& summary,
                   const ProgressSink& progress) {
    const Settings& settings = options.settings;
    if (options.mesh.empty()) {
        MesherOptions mesher = options.mesher;
        mesher.edge_length_mm = edge_length_mm;
        mesher.outer_edge_length_mm = 4.0 * edge_length_mm;
        return make_mesh(surface, reference.regions, reference.field, hollow_regions(settings),
                         mesher, &summary, progress);
    }
    const Mesh mesh =
        with_region_numbers(read_vtu(options.mesh), settings, options.mesh.filename().string());
    summary.mesher = "ready mesh";
    summary.quality = mesh_quality(mesh, settings.num_regions());
    return region_mesh_from_tets(mesh, reference.field, settings);
}

std::vector<std::uint8_t> seen_nodes(const Mesh& mesh, const LabelField& target,
                                     const RigidTransform& reference_to_target) {
    std::vector<std::uint8_t> seen(mesh.nodes.size());
    std::transform(mesh.nodes.begin(), mesh.nodes.end(), seen.begin(), [&](const Vec3& node) {
        return target.inside_box(reference_to_target.apply(node));
    });
    return seen;
}

ObservedMaps observed_maps(const LabelledState& reference, const LabelledState& target,
                           const RigidTransform& reference_to_target, const Settings& settings) {
    ObservedMaps maps;
    maps.reference = maps_of(reference.field, settings, is_matched);
    const RigidTransform back = reference_to_target.inverse();
    for (const auto& map : maps_of(target.field, settings, is_matched)) {
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

std::vector<ModulusPrior> modulus_priors(const RecoveryModel& recovery, const ReducedModel& model,
                                         const Settings& settings) {
    std::vector<ModulusPrior> priors;
    for (const Index region : recovery.unknown) {
        if (!model.has_region(region)) continue;
        priors.push_back(
            {region, std::log(prior_median_kpa(settings)), settings.prior.stiffness_sd_ln});
    }
    return priors;
}

std::vector<double> moduli_of(const Model& model) {
    std::vector<double> stiffness;
    for (const auto& material : model.materials) stiffness.push_back(material.stiffness_kpa);
    return stiffness;
}

}  // namespace

RecoveryResult recover(const RecoverOptions& options, const ProgressSink& progress) {
    const Settings& settings = options.settings;
    StageTimer timer;
    Recovered found;

    timer.start("reading");
    report_progress(progress, "reading", 0, "reading both segmentations");
    auto reading = std::async(std::launch::async, read_state, options.target, settings);
    const LabelledState reference = read_state(options.reference, settings);
    const LabelledState target = reading.get();

    timer.start("surfaces");
    SurfaceOptions surface_options;
    surface_options.edge_length_mm = edge_length_for(reference.regions, options.mesher.num_nodes);
    surface_options.outer_edge_length_mm = 4.0 * surface_options.edge_length_mm;
    report_progress(progress, "surfaces", 0,
                    fmt::format("edge length {:.2f} mm", surface_options.edge_length_mm));
    SurfaceSummary surfaces;
    const RegionSurface surface =
        extract_surfaces(reference.regions, reference.field, surface_options, &surfaces, progress);

    timer.start("aligning");
    found.alignment = align(options, reference, target, surface);
    check_overlap(reference, target, found.alignment, settings);
    const RigidTransform& transform = found.alignment.reference_to_target;
    report_progress(
        progress, "aligning", 1,
        fmt::format("{}: translation ({:.2f}, {:.2f}, {:.2f}) mm", found.alignment.method,
                    transform.translation[0], transform.translation[1], transform.translation[2]));

    timer.start("meshing");
    found.mesh = mesh_of(options, reference, surface, surface_options.edge_length_mm, found.mesher,
                         progress);
    found.recovery = build_model(found.mesh, settings);
    report_progress(progress, "meshing", 1,
                    fmt::format("{}: {} nodes ({} observed, {} driven), {} elements, smallest "
                                "dihedral angle {:.1f} deg",
                                found.mesher.mesher, found.mesh.mesh.num_nodes(),
                                found.recovery.observed.size(), found.recovery.driven.size(),
                                found.mesh.mesh.num_tets(), found.mesher.quality.min_dihedral_deg));

    timer.start("distances");
    found.maps = observed_maps(reference, target, transform, settings);
    const SurfaceObservations observations(
        found.recovery, found.maps, seen_nodes(found.mesh.mesh, target.field, transform),
        observation_options(settings, reference.regions.grid, target.regions.grid));

    timer.start("condensing");
    CondensationSummary condensation;
    const ReducedModel reduced(
        condense(found.recovery.model, found.recovery.observed, found.recovery.driven,
                 options.solver, &condensation, progress),
        static_cast<Index>(found.recovery.observed.size()),
        static_cast<Index>(found.recovery.driven.size()), moduli_of(found.recovery.model));

    timer.start("searching");
    const WallPrior walls(displacement_precision(found.recovery, settings.prior.displacement_sd_mm,
                                                 settings.prior.displacement_range_mm));
    const auto priors = modulus_priors(found.recovery, reduced, settings);
    const ResponseModel response =
        ResponseModel::compressed(reduced, walls, found.recovery.unknown, {});
    report_progress(
        progress, "searching", 0,
        fmt::format("{} wall motions, {} surface modes, {:.2g} mm left out",
                    response.num_functionals(), response.num_modes(), response.left_out_mm()));
    found.estimate = map_estimate(response, walls, observations, priors, options.search, progress);

    timer.start("solving");
    solve_full_model(found, options.solver, progress);

    timer.start("volumes");
    report_progress(progress, "volumes", 0, "carrying labels and field to the image grids");
    RecoveryResult result = assemble_result(found, reference.regions, reference.field,
                                            target.regions, target.field, settings);
    timer.stop();
    result.reference_name = options.reference.filename().string();
    result.target_name = options.target.filename().string();
    result.linear_solvers = {{"condensing", condensation.solver}, {"solving", found.solver}};
    result.timings_s = timer.times_s();
    return result;
}

}  // namespace palpate
