// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>

#include "host/geometry/meshing/mesher.hpp"
#include "host/io/label_image.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate::fixtures {

/// A box mesh whose tets carry the region of their centre; regions in `hollow` lose their tets. The
/// surface holds every face between two regions, the box included.
inline RegionMesh region_block(const std::array<Index, 3>& cubes, const Vec3& size_mm,
                               const std::function<Index(const Vec3&)>& region_of,
                               const std::vector<Index>& hollow) {
    const Mesh full = box_mesh(cubes, size_mm);
    RegionMesh block;
    block.mesh.nodes = full.nodes;
    std::map<std::array<Index, 3>, std::pair<Triangle, std::array<Index, 2>>> faces;
    for (const Tet& tet : full.tets) {
        Vec3 centre = Vec3::Zero();
        for (const Index node : tet) centre += 0.25 * full.nodes[node];
        // Cubes belong to one region as a whole, so that cavities have flat walls.
        const Vec3 edge = size_mm.cwiseQuotient(Vec3(cubes[0], cubes[1], cubes[2]));
        const Vec3 cube = centre.cwiseQuotient(edge).array().floor() + 0.5;
        const Index region = region_of(cube.cwiseProduct(edge));
        if (std::find(hollow.begin(), hollow.end(), region) == hollow.end()) {
            block.mesh.tets.push_back(tet);
            block.mesh.region.push_back(region);
        }
        for (const Triangle& face : {Triangle{tet[0], tet[2], tet[1]},
                                     {tet[0], tet[1], tet[3]},
                                     {tet[1], tet[2], tet[3]},
                                     {tet[0], tet[3], tet[2]}}) {
            Triangle key = face;
            std::sort(key.begin(), key.end());
            const auto [at, is_new] =
                faces.try_emplace(key, face, std::array{region, outside_region});
            if (!is_new) at->second.second[1] = region;
        }
    }
    block.surface.vertices = block.mesh.nodes;
    for (const auto& [key, face] : faces) {
        if (face.second[0] == face.second[1]) continue;
        block.surface.triangles.push_back(face.first);
        block.surface.regions.push_back(face.second);
        block.surface.on_image_border.push_back(face.second[1] == outside_region);
    }
    return block;
}

}  // namespace palpate::fixtures
