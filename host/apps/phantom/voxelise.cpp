// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/voxelise.hpp"

#include <algorithm>

#include "host/geometry/meshing/rasterise.hpp"
#include "host/geometry/surfaces/closest_point.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

/// All walls without mesh on one side, as one surface; `region` is the region behind each triangle:
/// a hollow organ or, on the box, `background_region`.
struct Walls {
    Surface surface;
    std::vector<Index> region;
};

Walls collect_walls(const RegionMesh& mesh, const std::vector<Vec3>& nodes,
                    const std::vector<Index>& hollow) {
    Walls walls;
    walls.surface.vertices = nodes;
    for (Index t = 0; t < mesh.surface.num_triangles(); ++t) {
        const auto& regions = mesh.surface.regions[t];
        for (const Index region : regions) {
            const bool is_hollow = std::find(hollow.begin(), hollow.end(), region) != hollow.end();
            if (!is_hollow && region != outside_region) continue;
            walls.surface.triangles.push_back(mesh.surface.triangles[t]);
            walls.region.push_back(is_hollow ? region : background_region);
            break;
        }
    }
    return walls;
}

}  // namespace

RegionImage regions_on_grid(const RegionMesh& mesh, const std::vector<Vec3>& nodes,
                            const std::vector<Index>& hollow, const ImageGrid& grid) {
    const std::vector<Index> tet_of = tet_of_voxels(mesh.mesh, nodes, grid);
    const Walls walls = collect_walls(mesh, nodes, hollow);
    const ClosestPointQuery nearest_wall(walls.surface);
    RegionImage image{grid, std::vector<std::uint8_t>(grid.num_voxels(), background_region)};
    parallel_ranges(grid.size[1], 1, [&](Index begin, Index end) {
        for (Index k = 0; k < grid.size[2]; ++k) {
            for (Index j = begin; j < end; ++j) {
                for (Index i = 0; i < grid.size[0]; ++i) {
                    const Index tet = tet_of[grid.offset(i, j, k)];
                    const auto region =
                        tet >= 0 ? mesh.mesh.region[tet]
                                 : walls.region[nearest_wall.closest(grid.to_point(Vec3(i, j, k)))
                                                    .triangle];
                    image.at(i, j, k) = static_cast<std::uint8_t>(region);
                }
            }
        }
    });
    return image;
}

}  // namespace palpate
