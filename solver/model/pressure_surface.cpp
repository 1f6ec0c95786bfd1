// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/pressure_surface.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "solver/base/error.hpp"
#include "solver/model/refuse.hpp"

namespace palpate {
namespace {

void add_triangle_point(double xi, double eta, double weight, ElementType type,
                        std::vector<ParametricPoint>& points) {
    const double place[] = {xi, eta};
    const ShapeFunctions at = shape_functions(type, place);
    ParametricPoint point;
    for (int a = 0; a < element_table(type).num_nodes; ++a) {
        point.value[a] = at.value[a];
        for (int j = 0; j < 2; ++j) point.slope[j][a] = at.gradient[a][j];
    }
    point.weight = weight;
    points.push_back(point);
}

/// Six points, exact to degree 4 (Strang and Fix 1973).
std::vector<ParametricPoint> triangle_rule(ElementType type) {
    const double root = std::sqrt(10), spread = std::sqrt(38 - 44 * std::sqrt(0.4));
    const double weight_root = std::sqrt(213125 - 53320 * root);
    std::vector<ParametricPoint> points;
    for (const double sign : {1.0, -1.0}) {
        const double a = (8 - root + sign * spread) / 18;
        const double weight = 0.5 * (620 + sign * weight_root) / 3720;
        add_triangle_point(a, a, weight, type, points);
        add_triangle_point(1 - 2 * a, a, weight, type, points);
        add_triangle_point(a, 1 - 2 * a, weight, type, points);
    }
    return points;
}

/// Three Gauss points on [-1, 1], exact to degree 5; the third node of a quadratic edge is its
/// middle.
std::vector<ParametricPoint> edge_rule(bool is_linear) {
    const double far = std::sqrt(0.6);
    const double place[] = {-far, 0, far}, weight[] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
    std::vector<ParametricPoint> points;
    for (int q = 0; q < 3; ++q) {
        const double t = place[q];
        ParametricPoint point;
        point.weight = weight[q];
        if (is_linear) {
            point.value = {0.5 * (1 - t), 0.5 * (1 + t)};
            point.slope[0] = {-0.5, 0.5};
        } else {
            point.value = {0.5 * t * (t - 1), 0.5 * t * (t + 1), 1 - t * t};
            point.slope[0] = {t - 0.5, t + 0.5, -2 * t};
        }
        points.push_back(point);
    }
    return points;
}

Mat3 cross_matrix(const Vec3& v) {
    Mat3 m;
    // m w = v x w
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

Vec3 turned(const Vec3& along) { return {along.y(), -along.x(), 0}; }

}  // namespace

void check_pressure_surface(const PressureSurface& surface, const SolidMesh& mesh) {
    const bool is_solid = mesh.formulation == Formulation::solid;
    for (const Face& face : surface.faces) {
        const bool has_size =
            is_solid ? face.size() == 3 || face.size() == 6 : face.size() == 2 || face.size() == 3;
        if (!has_size)
            refuse("a following pressure acts on a face of " + std::to_string(face.size()) +
                   " nodes; faces of this mesh have " + (is_solid ? "3 or 6" : "2 or 3"));
        for (const Index node : face)
            if (node < 0 || node >= mesh.num_nodes())
                refuse("a following pressure acts on a face with node " + std::to_string(node) +
                       "; the mesh has " + std::to_string(mesh.num_nodes()));
    }
}

const std::vector<ParametricPoint>& parametric_points(Formulation formulation,
                                                      std::size_t num_nodes) {
    static const std::vector<ParametricPoint> triangle = triangle_rule(ElementType::tri3),
                                              curved = triangle_rule(ElementType::tri6),
                                              edge = edge_rule(true), bent = edge_rule(false);
    if (formulation == Formulation::solid) return num_nodes == 3 ? triangle : curved;
    return num_nodes == 2 ? edge : bent;
}

DeformedArea::DeformedArea(const SolidMesh& mesh, const ParametricPoint& point,
                           const std::array<Vec3, 6>& place, std::size_t num_nodes)
    : mesh_(mesh), point_(point) {
    double x = 0;
    for (std::size_t a = 0; a < num_nodes; ++a) {
        x += point.value[a] * place[a].x();
        // x,j = sum N_a,j x_a
        for (int j = 0; j < 2; ++j) along_[j] += point.slope[j][a] * place[a];
    }
    if (mesh.formulation == Formulation::solid) {
        area_ = along_[0].cross(along_[1]);
        return;
    }
    depth_ = mesh.formulation == Formulation::axisymmetric ? 2 * std::numbers::pi * x
                                                           : mesh.thickness_mm;
    area_ = depth_ * turned(along_[0]);
}

Mat3 DeformedArea::slope(std::size_t b) const {
    if (mesh_.formulation == Formulation::solid)
        // d(x,1 x x,2)/dx_b = N_b,2 [x,1]x - N_b,1 [x,2]x
        return point_.slope[1][b] * cross_matrix(along_[0]) -
               point_.slope[0][b] * cross_matrix(along_[1]);
    Mat3 slope = Mat3::Zero();
    // d(depth (y,1, -x,1))/dx_b = depth N_b,1 [[0, 1], [-1, 0]] + (y,1, -x,1) (d depth/dx_b)
    slope(0, 1) = depth_ * point_.slope[0][b];
    slope(1, 0) = -slope(0, 1);
    if (mesh_.formulation == Formulation::axisymmetric)
        slope.col(0) += 2 * std::numbers::pi * point_.value[b] * turned(along_[0]);
    return slope;
}

}  // namespace palpate
