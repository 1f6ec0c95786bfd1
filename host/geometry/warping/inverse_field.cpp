// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/inverse_field.hpp"

#include <atomic>

#include "host/geometry/meshing/rasterise.hpp"
#include "host/geometry/warping/displacement_field.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

constexpr double tolerance_mm = 1e-3, unsure_mm = 1e-2;

/// Inverts x -> transform(x + u(x)) at the voxels of `inverse` that are `unknown`. Returns in how
/// many that failed.
std::size_t invert_by_iteration(const Image<Vec3>& field, const RigidTransform& transform,
                                const std::vector<std::uint8_t>& unknown, Image<Vec3>& inverse) {
    const RigidTransform back = transform.inverse();
    const ImageGrid& grid = inverse.grid;
    std::atomic<std::size_t> num_unsure{0};
    parallel_ranges(grid.size[1] * grid.size[2], 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const Index j = static_cast<Index>(row) % grid.size[1];
            const Index k = static_cast<Index>(row) / grid.size[1];
            Vec3 shift = Vec3::Zero();  // of the voxel before, a good start for this one
            for (Index i = 0; i < grid.size[0]; ++i) {
                if (!unknown[grid.offset(i, j, k)]) continue;
                const Vec3 y = grid.to_point(Vec3(i, j, k)), aligned = back.apply(y);
                const Origin found = origin_of(field, aligned, aligned - shift, tolerance_mm);
                const bool is_good = found.defect_mm <= unsure_mm;
                num_unsure += !is_good;
                shift = is_good ? Vec3(aligned - found.point) : Vec3::Zero();
                inverse.at(i, j, k) = found.point - y;
            }
        }
    });
    return num_unsure;
}

}  // namespace

InverseField inverse_field(const Mesh& mesh, const std::vector<Vec3>& displacement,
                           const Image<Vec3>& field, const RigidTransform& transform,
                           const ImageGrid& grid) {
    std::vector<Vec3> moved(mesh.nodes.size()), way_back(mesh.nodes.size());
    for (std::size_t n = 0; n < moved.size(); ++n) {
        moved[n] = transform.apply(mesh.nodes[n] + displacement[n]);
        way_back[n] = mesh.nodes[n] - moved[n];
    }
    FieldInMesh inside = interpolate_in_mesh(mesh, moved, way_back, grid);
    InverseField inverse{std::move(inside.field)};
    inverse.num_unsure = invert_by_iteration(field, transform, inside.is_outside, inverse.field);
    return inverse;
}

InverseField inverse_field(const Image<Vec3>& field, const ImageGrid& grid) {
    InverseField inverse{{grid, std::vector<Vec3>(grid.num_voxels())}};
    inverse.num_unsure = invert_by_iteration(
        field, {}, std::vector<std::uint8_t>(grid.num_voxels(), 1), inverse.field);
    return inverse;
}

}  // namespace palpate
