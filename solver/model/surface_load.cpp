// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/surface_load.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace palpate {
namespace {

std::vector<FacePoint> triangle_points(const SolidMesh& mesh, const Face& face) {
    const ElementType type = face.size() == 3 ? ElementType::tri3 : ElementType::tri6;
    const ElementTable& rule = element_table(ElementType::tri6);
    std::vector<FacePoint> points;
    for (int q = 0; q < rule.num_points; ++q) {
        const ShapeFunctions at = shape_functions(type, &rule.place[2 * q]);
        FacePoint point;
        Vec3 along[2] = {Vec3::Zero(), Vec3::Zero()};
        for (std::size_t a = 0; a < face.size(); ++a) {
            point.value[a] = at.value[a];
            point.place += at.value[a] * mesh.nodes[face[a]];
            for (int j = 0; j < 2; ++j) along[j] += at.gradient[a][j] * mesh.nodes[face[a]];
        }
        const Vec3 area = rule.weight[q] * along[0].cross(along[1]);
        point.area = area.norm();
        point.normal = area / point.area;
        points.push_back(point);
    }
    return points;
}

/// mm that an edge extends across its plane.
double depth_at(const SolidMesh& mesh, const Vec3& place) {
    if (mesh.formulation == Formulation::solid) return 1;
    if (mesh.formulation == Formulation::axisymmetric) return 2 * std::numbers::pi * place.x();
    return mesh.thickness_mm;
}

/// Three Gauss points on [-1, 1]; the third node of a quadratic edge is its middle.
std::vector<FacePoint> edge_points(const SolidMesh& mesh, const Face& face) {
    static const double far = std::sqrt(0.6);
    const double place[] = {-far, 0, far}, weight[] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
    std::vector<FacePoint> points;
    for (int q = 0; q < 3; ++q) {
        const double t = place[q];
        const bool is_linear = face.size() == 2;
        const double value[] = {is_linear ? 0.5 * (1 - t) : 0.5 * t * (t - 1),
                                is_linear ? 0.5 * (1 + t) : 0.5 * t * (t + 1), 1 - t * t};
        const double slope[] = {is_linear ? -0.5 : t - 0.5, is_linear ? 0.5 : t + 0.5, -2 * t};
        FacePoint point;
        Vec3 along = Vec3::Zero();
        for (std::size_t a = 0; a < face.size(); ++a) {
            point.value[a] = value[a];
            point.place += value[a] * mesh.nodes[face[a]];
            along += slope[a] * mesh.nodes[face[a]];
        }
        point.area = weight[q] * along.norm() * depth_at(mesh, point.place);
        point.normal = Vec3(along.y(), -along.x(), 0).normalized();
        points.push_back(point);
    }
    return points;
}

}  // namespace

std::vector<Face> boundary_faces(const SolidMesh& mesh,
                                 const std::function<bool(Index node)>& is_wanted) {
    // Both owners of an inner face have the same nodes, so unwanted faces can be left out first.
    std::map<Face, int> times_met;
    const auto sorted = [](Face face) {
        std::sort(face.begin(), face.end());
        return face;
    };
    std::vector<Face> all;
    for (Index e = 0; e < mesh.num_elements(); ++e)
        for (const auto& local : mesh.table().faces) {
            Face face;
            for (const int a : local) face.push_back(mesh.nodes_of(e)[a]);
            if (is_wanted && !std::all_of(face.begin(), face.end(), is_wanted)) continue;
            ++times_met[sorted(face)];
            all.push_back(std::move(face));
        }
    std::erase_if(all, [&](const Face& face) { return times_met.at(sorted(face)) > 1; });
    return all;
}

std::vector<FacePoint> face_points(const SolidMesh& mesh, const Face& face) {
    return mesh.formulation == Formulation::solid ? triangle_points(mesh, face)
                                                  : edge_points(mesh, face);
}

Eigen::VectorXd traction_forces(const SolidMesh& mesh, const std::vector<Face>& faces,
                                const Traction& traction) {
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(3 * mesh.num_nodes());
    for (const Face& face : faces)
        for (const FacePoint& point : face_points(mesh, face)) {
            const Vec3 force = point.area * traction(point.place, point.normal);
            for (std::size_t a = 0; a < face.size(); ++a)
                forces.segment<3>(3 * face[a]) += point.value[a] * force;
        }
    return forces;
}

}  // namespace palpate
