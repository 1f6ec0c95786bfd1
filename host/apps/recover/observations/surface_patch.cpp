// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/observations/surface_patch.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace palpate {
namespace {

constexpr double least_weight = 0.02;

/// The weights nearest to equal ones for which sum w = 1 and sum w p = 0 along the surface:
///   w = 1/m + A^T (A A^T)^-1 (b - A 1/m),   A = [1; t1 . p; t2 . p],   b = (1, 0, 0)
/// (least squares under linear conditions). Empty where there are none, or one is hardly positive.
std::vector<double> weights_of(const std::vector<Vec3>& offsets, const Vec3& normal) {
    const Index m = static_cast<Index>(offsets.size());
    const Vec3 first = normal.unitOrthogonal(), second = normal.cross(first);
    Eigen::Matrix<double, 3, Eigen::Dynamic> conditions(3, m);
    for (Index k = 0; k < m; ++k)
        conditions.col(k) << 1, first.dot(offsets[k]), second.dot(offsets[k]);
    const Eigen::VectorXd even = Eigen::VectorXd::Constant(m, 1.0 / static_cast<double>(m));
    const Vec3 missing = Vec3::UnitX() - conditions * even;
    const Mat3 square = conditions * conditions.transpose();
    const Eigen::VectorXd weights = even + conditions.transpose() * square.ldlt().solve(missing);
    if (!weights.allFinite() || weights.minCoeff() < least_weight) return {};
    return {weights.begin(), weights.end()};
}

}  // namespace

std::vector<SurfacePatch> surface_patches(const Surface& surface,
                                          const std::vector<Vec3>& normals) {
    const auto neighbours = vertex_neighbours(surface);
    std::vector<SurfacePatch> patches(surface.vertices.size());
    for (std::size_t v = 0; v < patches.size(); ++v) {
        SurfacePatch patch;
        for (const Index other : neighbours[v]) {
            patch.offsets.push_back(0.5 * (surface.vertices[other] - surface.vertices[v]));
            patch.ends.push_back(other);
        }
        patch.weights = weights_of(patch.offsets, normals[v]);
        if (!patch.weights.empty()) patches[v] = std::move(patch);
    }
    return patches;
}

}  // namespace palpate
