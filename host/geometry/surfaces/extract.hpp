// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/geometry/fields/label_field.hpp"
#include "host/geometry/surfaces/surface.hpp"
#include "solver/base/log.hpp"

namespace palpate {

struct SurfaceOptions {
    double edge_length_mm = 3.0;         ///< wanted edge length on organ surfaces
    double outer_edge_length_mm = 12.0;  ///< wanted edge length on the image box far from organs
    double volume_tolerance = 0.02;      ///< allowed relative difference to the voxel volume
};

/// What was checked on the surface that is returned.
struct SurfaceSummary {
    struct Region {
        Index region = 0;
        double voxel_volume_mm3 = 0;
        double surface_volume_mm3 = 0;
        bool cut_by_image = false;  ///< part of its surface is a cap on the image box
    };
    std::vector<Region> regions;
    Index self_intersections = 0;  ///< always 0 on return
    double seconds = 0;
};

/// One conforming triangle surface between all regions of `image`, image box included (everything
/// beyond the box is `outside_region`). Made from the smooth `field` at the wanted edge length,
/// vertices on the interfaces of the field, each region's volume kept within the tolerance, no two
/// triangles crossing, every region's surface a closed 2-manifold.
/// Throws Error(input_unusable) for a region too small for the edge length, Error(mesh_failed) if
/// the rules cannot be met, naming the region and the remedy.
RegionSurface extract_surfaces(const RegionImage& image, const LabelField& field,
                               const SurfaceOptions& options, SurfaceSummary* summary = nullptr,
                               const ProgressSink& progress = {});

/// The same, with the remedy that its errors name: where an organ is too small or too thin for the
/// edges, or no valid surface comes out, again with edges of 0.7 and of half that length, but of no
/// less than a voxel; then with volumes within 5 %. `options` becomes what was used; `reason`, if
/// given, why the first attempt failed. Throws what that threw if none succeeds.
RegionSurface extract_surfaces_finely(const RegionImage& image, const LabelField& field,
                                      SurfaceOptions& options, std::string* reason = nullptr,
                                      const ProgressSink& progress = {});

}  // namespace palpate
