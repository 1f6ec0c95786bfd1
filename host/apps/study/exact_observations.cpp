// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/exact_observations.hpp"

#include <memory>
#include <utility>

#include "host/geometry/surfaces/surface_shape.hpp"

namespace palpate {
namespace {

constexpr double least_noise_mm = 0.001;  ///< far below what a voxel leaves

/// The surfaces of the organs that are matched, before and after.
ObservedShapes shapes_of(const RecoveryModel& recovery, const std::vector<Vec3>& displacement) {
    ObservedShapes shapes;
    for (const ObservedSurface& organ : recovery.surfaces) {
        Surface moved = organ.surface;
        for (std::size_t v = 0; v < moved.vertices.size(); ++v) {
            moved.vertices[v] += displacement[organ.node_of[v]];
        }
        shapes.reference.push_back(std::make_shared<SurfaceShape>(organ.surface));
        shapes.target.push_back(std::make_shared<SurfaceShape>(std::move(moved)));
    }
    return shapes;
}

}  // namespace

SurfaceObservations exact_observations(const RecoveryModel& recovery, const PelvisPhantom& phantom,
                                       double noise_mm) {
    ObservationOptions seen;
    seen.noise_mm = noise_mm;
    seen.independent_area_mm2 = 1e-3;
    return SurfaceObservations(
        recovery,
        shapes_of(build_model(body_mesh(phantom.mesh), phantom.settings), phantom.displacement),
        std::vector<std::uint8_t>(recovery.model.mesh.nodes.size(), 1), seen);
}

MapOptions exact_search(double noise_mm) {
    MapOptions search;
    search.max_iterations = 150;
    search.modulus_tolerance_sd = 0.02;
    search.noise_iterations = 30;
    search.contour_mm = 0;
    search.fit_walls = false;
    search.smallest_noise_scale = least_noise_mm / noise_mm;
    return search;
}

ResponseOptions exact_response(double tolerance_mm) {
    ResponseOptions response;
    response.tolerance_mm = tolerance_mm;
    return response;
}

}  // namespace palpate
