// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "solver/model/surface_load.hpp"

namespace palpate {

/// A part of the surface on which a pressure acts that follows it: on the deformed area, against
/// the deformed outward normal.
struct PressureSurface {
    std::vector<Face> faces;
};

/// Throws Error(invalid_argument) for a face with a node that the mesh has not, or with a number of
/// nodes that no face of its formulation has.
void check_pressure_surface(const PressureSurface& surface, const SolidMesh& mesh);

/// A quadrature point in a face's own coordinates xi (two of a triangle, one of an edge).
struct ParametricPoint {
    std::array<double, 6> value{};                 ///< N_a
    std::array<std::array<double, 6>, 2> slope{};  ///< dN_a / dxi_j
    double weight = 0;                             ///< of the reference face
};

/// The points of a face with that many nodes: enough for the exact integral of N_a times the area
/// of the deformed face, a polynomial in xi of degree 0 on tri3, 4 on tri6, at most 5 on edges.
const std::vector<ParametricPoint>& parametric_points(Formulation formulation,
                                                      std::size_t num_nodes);

/// The area vector c of a deformed face per unit of xi, mm^2, outward, and how it changes:
///   triangles          c = x,1 x x,2
///   edges in a plane   c = thickness (y,1, -x,1, 0), the thickness as the mesh has it
///   about an axis      c = 2 pi x (y,1, -x,1, 0), the whole circumference
class DeformedArea {
public:
    ///   place   of the face's nodes, deformed, mm
    DeformedArea(const SolidMesh& mesh, const ParametricPoint& point,
                 const std::array<Vec3, 6>& place, std::size_t num_nodes);

    const Vec3& vector() const { return area_; }
    /// dc / dx_b, [3, 3] mm.
    Mat3 slope(std::size_t b) const;

private:
    const SolidMesh& mesh_;
    const ParametricPoint& point_;
    double depth_ = 1;                              ///< mm across an edge's plane
    Vec3 along_[2] = {Vec3::Zero(), Vec3::Zero()};  ///< x,j
    Vec3 area_;
};

}  // namespace palpate
