// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/meshing/rasterise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "host/imaging/parallel.hpp"
#include "host/meshing/laplace_fill.hpp"
#include "solver/base/error.hpp"

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

/// The displacement as an affine function of the voxel index in each tet: [constant | slope].
std::vector<Eigen::Matrix<double, 3, 4>> affine_displacements(
    const Mesh& mesh, const std::vector<Vec3>& indices, const std::vector<Vec3>& displacement) {
    std::vector<Eigen::Matrix<double, 3, 4>> affine(mesh.tets.size());
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const TetWeights weights(corners(mesh.tets[t], indices));
        affine[t].setZero();
        if (weights.is_flat) continue;
        for (int c = 0; c < 4; ++c) {
            const Vec3& u = displacement[mesh.tets[t][c]];
            affine[t].col(0) += weights.constant[c] * u;
            affine[t].rightCols<3>() += u * weights.slope.row(c);
        }
    }
    return affine;
}

/// Linear interpolation at a continuous voxel index, clamped to the voxel centres.
Vec3 interpolate(const Image<Vec3>& field, const Vec3& index) {
    std::array<Index, 3> low{}, high{};
    Vec3 t;
    for (int axis = 0; axis < 3; ++axis) {
        const double x = std::clamp(index[axis], 0.0, field.grid.size[axis] - 1.0);
        low[axis] = static_cast<Index>(x);
        high[axis] = std::min<Index>(low[axis] + 1, field.grid.size[axis] - 1);
        t[axis] = x - low[axis];
    }
    const auto along_i = [&](Index j, Index k) -> Vec3 {
        return (1 - t[0]) * field.at(low[0], j, k) + t[0] * field.at(high[0], j, k);
    };
    const auto along_j = [&](Index k) -> Vec3 {
        return (1 - t[1]) * along_i(low[1], k) + t[1] * along_i(high[1], k);
    };
    return (1 - t[2]) * along_j(low[2]) + t[2] * along_j(high[2]);
}

/// Finds x with x + u(x) = y by x <- x + step (y - x - u(x)); the step is halved when the defect
/// grows, so that fields steeper than 1 still converge. `x` is the start.
Vec3 origin_of(const Vec3& y, Vec3 x, const Image<Vec3>& displacement, double tolerance_mm) {
    constexpr int max_iterations = 60;
    constexpr double smallest_step = 0.05;
    double step = 1.0;
    Vec3 defect = y - x - interpolate(displacement, displacement.grid.to_index(x));
    for (int n = 0; n < max_iterations && defect.norm() > tolerance_mm; ++n) {
        const Vec3 next = x + step * defect;
        const Vec3 next_defect =
            y - next - interpolate(displacement, displacement.grid.to_index(next));
        if (next_defect.norm() > defect.norm() && step > smallest_step) {
            step *= 0.5;
            continue;
        }
        x = next;
        defect = next_defect;
    }
    return x;
}

std::uint16_t nearest_label(const LabelImage& labels, const Vec3& point) {
    const Vec3 index = labels.grid.to_index(point);
    std::array<Index, 3> voxel{};
    for (int axis = 0; axis < 3; ++axis) {
        const double rounded = std::floor(index[axis] + 0.5);
        if (!(rounded >= 0 && rounded < labels.grid.size[axis])) return 0;
        voxel[axis] = static_cast<Index>(rounded);
    }
    return labels.at(voxel[0], voxel[1], voxel[2]);
}

}  // namespace

std::vector<Index> tet_of_voxels(const Mesh& mesh, const std::vector<Vec3>& nodes,
                                 const ImageGrid& grid) {
    check_sizes(mesh, nodes.size(), "The list of node positions");
    const std::vector<Vec3> indices = to_voxel_indices(nodes, grid);
    std::vector<Index> tet_of(grid.num_voxels(), -1);
    parallel_for(grid.size[2], [&](Index first_slice, Index end_slice) {
        for (Index t = 0; t < mesh.num_tets(); ++t) {
            mark_tet(t, corners(mesh.tets[t], indices), grid, first_slice, end_slice, tet_of);
        }
    });
    return tet_of;
}

Image<Vec3> displacement_on_grid(const Mesh& mesh, const std::vector<Vec3>& displacement,
                                 const ImageGrid& grid) {
    check_sizes(mesh, displacement.size(), "The displacement");
    const std::vector<Index> tet_of = tet_of_voxels(mesh, mesh.nodes, grid);
    const auto affine =
        affine_displacements(mesh, to_voxel_indices(mesh.nodes, grid), displacement);
    Image<Vec3> field{grid, std::vector<Vec3>(grid.num_voxels(), Vec3::Zero())};
    std::vector<std::uint8_t> unknown(grid.num_voxels(), 0);
    parallel_for(grid.size[2], [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k) {
            for (Index j = 0; j < grid.size[1]; ++j) {
                for (Index i = 0; i < grid.size[0]; ++i) {
                    const std::size_t at = grid.offset(i, j, k);
                    unknown[at] = tet_of[at] < 0;
                    if (unknown[at]) continue;
                    field.voxels[at] = affine[tet_of[at]] * Eigen::Vector4d(1, i, j, k);
                }
            }
        }
    });
    laplace_fill(field, unknown);
    return field;
}

LabelImage warp_labels(const LabelImage& labels, const Image<Vec3>& displacement,
                       const ImageGrid& out_grid) {
    const double tolerance_mm = 0.01 * out_grid.spacing.minCoeff();
    LabelImage out{out_grid, std::vector<std::uint16_t>(out_grid.num_voxels(), 0)};
    parallel_for(out_grid.size[2], [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k) {
            for (Index j = 0; j < out_grid.size[1]; ++j) {
                Vec3 shift = Vec3::Zero();  // of the voxel before, a good start for this one
                for (Index i = 0; i < out_grid.size[0]; ++i) {
                    const Vec3 y = out_grid.to_point(Vec3(i, j, k));
                    const Vec3 x = origin_of(y, y - shift, displacement, tolerance_mm);
                    shift = y - x;
                    out.at(i, j, k) = nearest_label(labels, x);
                }
            }
        }
    });
    return out;
}

}  // namespace palpate
