// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/observed_target.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

VoxelPlanes voxel_planes(const LabelledState& state, const RigidTransform& to_reference) {
    const ImageGrid& grid = state.regions.grid;
    return {to_reference.apply(grid.origin), to_reference.rotation * grid.direction, grid.spacing,
            state.field.smoothing_mm()};
}

}  // namespace

TargetShapes target_shapes(const TargetState& target, const Settings& settings) {
    TargetShapes shapes;
    if (!target.labels) {
        for (const auto& shown : target.shown) shapes.push_back(shown.shape);
        return shapes;
    }
    const RigidTransform back = target.alignment.reference_to_target.inverse();
    for (const auto& map : maps_of_matched(target.labels->field, settings, target_margin_mm)) {
        shapes.push_back(std::make_shared<DistanceMap>(map.moved(back)));
    }
    return shapes;
}

std::future<TargetShapes> start_target_shapes(const TargetState& target, const Settings& settings) {
    return std::async(std::launch::async, [&] { return target_shapes(target, settings); });
}

bool in_field_of_view(const TargetState& target, const Vec3& point) {
    if (!target.labels) return true;
    return target.labels->field.inside_box(target.alignment.reference_to_target.apply(point));
}

double contour_images(const TargetState& target) { return target.labels ? std::numbers::sqrt2 : 1; }

ObservationOptions observation_options(const Settings& settings, const LabelledState& reference,
                                       const TargetState& target) {
    double volume = reference.regions.grid.voxel_volume();
    if (target.labels) volume = std::max(volume, target.labels->regions.grid.voxel_volume());
    const double voxel = std::cbrt(volume);
    ObservationOptions options;
    options.noise_mm = settings.prior.noise_voxels * voxel;
    options.independent_area_mm2 = 2.0 * voxel * voxel;
    options.voxels = {voxel_planes(reference, {})};
    options.aligned = target.alignment.points;
    if (target.labels) {
        options.voxels.push_back(
            voxel_planes(*target.labels, target.alignment.reference_to_target.inverse()));
    } else {
        // The setting is for two label volumes, which share its variance.
        options.noise_mm = std::hypot(options.noise_mm / std::numbers::sqrt2, target.noise_mm);
    }
    return options;
}

}  // namespace palpate
