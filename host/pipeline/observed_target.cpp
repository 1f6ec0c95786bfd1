// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/pipeline/observed_target.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

VoxelPlanes voxel_planes(const LabelledState& state, const Mat3& to_reference) {
    const ImageGrid& grid = state.regions.grid;
    return {to_reference * grid.direction, grid.spacing, state.field.smoothing_mm()};
}

}  // namespace

std::vector<std::shared_ptr<const TargetShape>> target_shapes(const TargetState& target,
                                                              const Settings& settings) {
    const RigidTransform back = target.alignment.reference_to_target.inverse();
    std::vector<std::shared_ptr<const TargetShape>> shapes;
    for (const auto& map : maps_of_matched(target.labels->field, settings)) {
        shapes.push_back(std::make_shared<DistanceMap>(map.moved(back)));
    }
    return shapes;
}

bool in_field_of_view(const TargetState& target, const Vec3& point) {
    return target.labels->field.inside_box(target.alignment.reference_to_target.apply(point));
}

ObservationOptions observation_options(const Settings& settings, const LabelledState& reference,
                                       const TargetState& target) {
    const double voxel = std::cbrt(std::max(reference.regions.grid.voxel_volume(),
                                            target.labels->regions.grid.voxel_volume()));
    ObservationOptions options;
    options.noise_mm = settings.prior.noise_voxels * voxel;
    options.independent_area_mm2 = 2.0 * voxel * voxel;
    options.voxels = {
        voxel_planes(reference, Mat3::Identity()),
        voxel_planes(*target.labels, target.alignment.reference_to_target.rotation.transpose())};
    return options;
}

}  // namespace palpate
