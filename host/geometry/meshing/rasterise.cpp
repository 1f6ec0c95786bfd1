// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/rasterise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "host/geometry/meshing/laplace_fill.hpp"
#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

void check_sizes(const Mesh& mesh, std::size_t num_values, const char* what) {
    if (num_values == mesh.nodes.size()) return;
    throw Error(ErrorCode::invalid_argument,
                std::string(what) + " has " + std::to_string(num_values) +
                    " entries, but the mesh has " + std::to_string(mesh.nodes.size()) + " nodes.");
}

/// Barycentric coordinates along voxel rows: weight_c(x) = constant_c + slope_c . x, x a voxel
/// index.
struct TetWeights {
    Eigen::Vector4d constant;
    Eigen::Matrix<double, 4, 3> slope;
    bool is_flat = false;

    explicit TetWeights(const std::array<Vec3, 4>& corner) {
        Mat3 edges;
        edges << corner[1] - corner[0], corner[2] - corner[0], corner[3] - corner[0];
        is_flat = std::abs(edges.determinant()) < 1e-12;
        if (is_flat) return;
        slope.bottomRows<3>() = edges.inverse();
        slope.row(0) = -slope.bottomRows<3>().colwise().sum();
        constant = -slope * corner[0];
        constant[0] += 1.0;
    }

    /// The range of i in the row (j, k) where all weights are at least -tolerance.
    std::array<double, 2> row_range(double j, double k) const {
        constexpr double tolerance = 1e-9;  // a centre on a face must not fall between two tets
        double low = -std::numeric_limits<double>::infinity(), high = -low;
        for (int c = 0; c < 4; ++c) {
            const double at_zero = constant[c] + slope(c, 1) * j + slope(c, 2) * k + tolerance;
            const double rate = slope(c, 0);
            if (rate > 0) {
                low = std::max(low, -at_zero / rate);
            } else if (rate < 0) {
                high = std::min(high, -at_zero / rate);
            } else if (at_zero < 0) {
                return {1.0, 0.0};
            }
        }
        return {low, high};
    }
};

/// First and last whole number in [low, high], cut to 0..size-1; empty if first > last.
std::array<Index, 2> whole_numbers(double low, double high, Index size) {
    const double first = std::max(0.0, std::ceil(low)),
                 last = std::min(size - 1.0, std::floor(high));
    if (!(first <= last)) return {1, 0};
    return {static_cast<Index>(first), static_cast<Index>(last)};
}

/// Marks the voxels of the slices first_slice..end_slice that lie in one tet and in none before it.
void mark_tet(Index tet, const std::array<Vec3, 4>& corner, const ImageGrid& grid,
              Index first_slice, Index end_slice, std::vector<Index>& tet_of) {
    constexpr double margin = 1e-6;
    Vec3 low = corner[0], high = corner[0];
    for (const Vec3& p : corner) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    auto [k0, k1] = whole_numbers(low[2] - margin, high[2] + margin, grid.size[2]);
    k0 = std::max(k0, first_slice);
    k1 = std::min(k1, end_slice - 1);
    const auto [j0, j1] = whole_numbers(low[1] - margin, high[1] + margin, grid.size[1]);
    if (k0 > k1 || j0 > j1) return;
    const TetWeights weights(corner);
    if (weights.is_flat) return;
    for (Index k = k0; k <= k1; ++k) {
        for (Index j = j0; j <= j1; ++j) {
            const auto [from, to] = weights.row_range(j, k);
            const auto [i0, i1] = whole_numbers(from, to, grid.size[0]);
            Index* row = tet_of.data() + grid.offset(0, j, k);
            for (Index i = i0; i <= i1; ++i) {
                if (row[i] < 0) row[i] = tet;
            }
        }
    }
}

std::vector<Vec3> to_voxel_indices(const std::vector<Vec3>& points, const ImageGrid& grid) {
    std::vector<Vec3> indices(points.size());
    std::transform(points.begin(), points.end(), indices.begin(),
                   [&](const Vec3& p) { return grid.to_index(p); });
    return indices;
}

std::array<Vec3, 4> corners(const Tet& tet, const std::vector<Vec3>& nodes) {
    return {nodes[tet[0]], nodes[tet[1]], nodes[tet[2]], nodes[tet[3]]};
}

/// Vectors at the nodes as an affine function of the voxel index in each tet: [constant | slope].
std::vector<Eigen::Matrix<double, 3, 4>> affine_values(const Mesh& mesh,
                                                       const std::vector<Vec3>& indices,
                                                       const std::vector<Vec3>& values) {
    std::vector<Eigen::Matrix<double, 3, 4>> affine(mesh.tets.size());
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const TetWeights weights(corners(mesh.tets[t], indices));
        affine[t].setZero();
        if (weights.is_flat) continue;
        for (int c = 0; c < 4; ++c) {
            const Vec3& u = values[mesh.tets[t][c]];
            affine[t].col(0) += weights.constant[c] * u;
            affine[t].rightCols<3>() += u * weights.slope.row(c);
        }
    }
    return affine;
}

}  // namespace

std::vector<Index> tet_of_voxels(const Mesh& mesh, const std::vector<Vec3>& nodes,
                                 const ImageGrid& grid) {
    check_sizes(mesh, nodes.size(), "The list of node positions");
    const std::vector<Vec3> indices = to_voxel_indices(nodes, grid);
    std::vector<Index> tet_of(grid.num_voxels(), -1);
    parallel_ranges(grid.size[2], 1, [&](Index first_slice, Index end_slice) {
        for (Index t = 0; t < mesh.num_tets(); ++t) {
            mark_tet(t, corners(mesh.tets[t], indices), grid, first_slice, end_slice, tet_of);
        }
    });
    return tet_of;
}

FieldInMesh interpolate_in_mesh(const Mesh& mesh, const std::vector<Vec3>& nodes,
                                const std::vector<Vec3>& values, const ImageGrid& grid) {
    check_sizes(mesh, values.size(), "The list of vectors");
    const std::vector<Index> tet_of = tet_of_voxels(mesh, nodes, grid);
    const auto affine = affine_values(mesh, to_voxel_indices(nodes, grid), values);
    FieldInMesh inside{{grid, std::vector<Vec3>(grid.num_voxels(), Vec3::Zero())},
                       std::vector<std::uint8_t>(grid.num_voxels(), 0)};
    parallel_ranges(grid.size[2], 1, [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k) {
            for (Index j = 0; j < grid.size[1]; ++j) {
                for (Index i = 0; i < grid.size[0]; ++i) {
                    const std::size_t at = grid.offset(i, j, k);
                    inside.is_outside[at] = tet_of[at] < 0;
                    if (inside.is_outside[at]) continue;
                    inside.field.voxels[at] = affine[tet_of[at]] * Eigen::Vector4d(1, i, j, k);
                }
            }
        }
    });
    return inside;
}

Image<Vec3> displacement_on_grid(const Mesh& mesh, const std::vector<Vec3>& displacement,
                                 const ImageGrid& grid) {
    FieldInMesh inside = interpolate_in_mesh(mesh, mesh.nodes, displacement, grid);
    laplace_fill(inside.field, inside.is_outside);
    return std::move(inside.field);
}

}  // namespace palpate
