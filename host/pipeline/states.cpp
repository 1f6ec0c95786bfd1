// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/pipeline/states.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include "host/imaging/io.hpp"
#include "host/meshing/rasterise.hpp"
#include "host/modelling/regions.hpp"
#include "host/pipeline/volumes.hpp"
#include "host/surfaces/extract.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

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

AlignmentResult align(const RecoverOptions& options, const ReferenceState& reference,
                      const LabelledState& target) {
    switch (method_for(options)) {
        case AlignMethod::transform:
            return {"transform", read_rigid_transform(options.initial_transform), 0};
        case AlignMethod::none:
            return {"none", {}, 0};
        case AlignMethod::fixed:
            return align_surfaces(reference.fixed_points,
                                  maps_of(target.field, options.settings, is_fixed), {});
        default:
            return {"centroid",
                    align_centroids(reference.state.regions, target.regions, options.settings), 0};
    }
}

void check_overlap(const LabelledState& reference, const LabelledState& target,
                   const AlignmentResult& alignment, const Settings& settings) {
    const auto carried =
        carry_regions(reference.field, alignment.reference_to_target, target.regions.grid);
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

}  // namespace

LabelledState make_state(const Segmentation& segmentation, const Settings& settings) {
    RegionImage regions = to_regions(segmentation.labels, settings, segmentation.name);
    LabelField field(regions, settings.num_regions());
    std::vector<std::string> warnings = segmentation.warnings;
    for (std::string& warning : thin_organs(regions, settings))
        warnings.push_back(std::move(warning));
    return {segmentation.name, std::move(regions), std::move(field), std::move(warnings)};
}

ReferenceState make_reference(LabelledState state, const RecoverOptions& options,
                              const ProgressSink& progress) {
    ReferenceState reference{std::move(state), 0, {}, {}};
    SurfaceOptions surface_options;
    surface_options.edge_length_mm =
        edge_length_for(reference.state.regions, options.mesher.num_nodes);
    surface_options.outer_edge_length_mm = 4.0 * surface_options.edge_length_mm;
    report_progress(progress, "surfaces", 0,
                    fmt::format("edge length {:.2f} mm", surface_options.edge_length_mm));
    const double wanted_mm = surface_options.edge_length_mm;
    std::string reason;
    reference.surface = extract_surfaces_finely(reference.state.regions, reference.state.field,
                                                surface_options, &reason, progress);
    reference.edge_length_mm = surface_options.edge_length_mm;
    if (!reason.empty())
        reference.state.warnings.push_back(
            fmt::format("The surfaces have edges of {:.2f} mm and volumes within {:.0f} % of the "
                        "voxels', not {:.2f} mm (for {} nodes) and {:.0f} %: {}",
                        reference.edge_length_mm, 100 * surface_options.volume_tolerance, wanted_mm,
                        options.mesher.num_nodes, 100 * SurfaceOptions{}.volume_tolerance, reason));
    reference.fixed_points = fixed_points(reference.surface, options.settings);
    return reference;
}

TargetState align_target(LabelledState target, const ReferenceState& reference,
                         const RecoverOptions& options, const ProgressSink& progress) {
    AlignmentResult alignment = align(options, reference, target);
    check_overlap(reference.state, target, alignment, options.settings);
    const Vec3& shift = alignment.reference_to_target.translation;
    report_progress(progress, "aligning", 1,
                    fmt::format("{}: translation ({:.2f}, {:.2f}, {:.2f}) mm", alignment.method,
                                shift[0], shift[1], shift[2]));
    std::string name = target.name;
    return {std::move(name), std::move(alignment), std::move(target), {}, 0};
}

std::vector<DistanceMap> maps_of_matched(const LabelField& field, const Settings& settings) {
    return maps_of(field, settings, is_matched);
}

}  // namespace palpate
