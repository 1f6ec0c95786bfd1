// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/mesh_probe.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace palpate {
namespace {

constexpr double tolerance = 1e-6;  // of the reference element
constexpr int most_steps = 20;

/// Whether xi is in the reference element: a simplex, or the square from -1 to 1.
bool is_within(ElementType type, const Eigen::VectorXd& xi) {
    if (type == ElementType::quad4) return xi.cwiseAbs().maxCoeff() <= 1 + tolerance;
    return xi.minCoeff() >= -tolerance && xi.sum() <= 1 + tolerance;
}

/// The box of an element's nodes, widened by a part of its size: curved edges bulge.
bool is_near(const SolidMesh& mesh, Index element, const Vec3& place) {
    Vec3 low = Vec3::Constant(1e300), high = -low;
    for (const Index node : mesh.nodes_of(element)) {
        low = low.cwiseMin(mesh.nodes[node]);
        high = high.cwiseMax(mesh.nodes[node]);
    }
    const double margin = 0.1 * (high - low).norm();
    return ((place - low).array() >= -margin).all() && ((high - place).array() >= -margin).all();
}

}  // namespace

Vec3 ProbedPlace::displacement(const Eigen::VectorXd& u) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t a = 0; a < nodes.size(); ++a) sum += weights[a] * u.segment<3>(3 * nodes[a]);
    return sum;
}

/// Newton's method on sum_a N_a(xi) X_a = place.
std::optional<std::array<double, 3>> MeshProbe::inside(Index element, const Vec3& place) const {
    const int dimension = mesh_.table().dimension;
    const auto nodes = mesh_.nodes_of(element);
    Eigen::VectorXd xi = Eigen::VectorXd::Constant(
        dimension, mesh_.type == ElementType::quad4 ? 0.0 : 1.0 / (dimension + 1));
    for (int step = 0; step < most_steps; ++step) {
        const ShapeFunctions at = shape_functions(mesh_.type, xi.data());
        Eigen::VectorXd left = place.head(dimension);
        Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(dimension, dimension);
        for (std::size_t a = 0; a < nodes.size(); ++a) {
            const Vec3& node = mesh_.nodes[nodes[a]];
            left -= at.value[a] * node.head(dimension);
            for (int j = 0; j < dimension; ++j)
                slope.col(j) += at.gradient[a][j] * node.head(dimension);
        }
        const Eigen::VectorXd change = slope.partialPivLu().solve(left);
        if (!change.allFinite() || change.norm() > 10) return std::nullopt;
        xi += change;
        if (change.norm() > 1e-12) continue;
        if (!is_within(mesh_.type, xi)) return std::nullopt;
        std::array<double, 3> found{};
        std::copy(xi.begin(), xi.end(), found.begin());
        return found;
    }
    return std::nullopt;
}

std::optional<ProbedPlace> MeshProbe::find(const Vec3& place) const {
    for (Index element = 0; element < mesh_.num_elements(); ++element) {
        if (!is_near(mesh_, element, place)) continue;
        const auto xi = inside(element, place);
        if (!xi) continue;
        const auto nodes = mesh_.nodes_of(element);
        const ShapeFunctions at = shape_functions(mesh_.type, xi->data());
        return ProbedPlace{{nodes.begin(), nodes.end()}, {at.value, at.value + nodes.size()}};
    }
    return std::nullopt;
}

}  // namespace palpate
