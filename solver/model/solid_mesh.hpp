// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "solver/elements/element.hpp"
#include "solver/mesh/node_elements.hpp"

namespace palpate {

/// What a mesh stands for. Displacements always have three components; in a plane the third is
/// zero.
enum class Formulation {
    solid,         ///< three-dimensional
    plane_strain,  ///< x, y; no strain across the plane
    plane_stress,  ///< x, y; no stress across the plane
    axisymmetric,  ///< x is the distance from the axis (>= 0), y runs along it; a full turn
};
/// "solid", "plane-strain", "plane-stress", "axisymmetric".
const char* name_of(Formulation formulation);
/// Throws Error(invalid_argument) naming those that there are.
Formulation formulation_of(const std::string& name);

/// A mesh of one element type for equilibrium at large deformation. mm.
struct SolidMesh {
    ElementType type = ElementType::tet4;
    Formulation formulation = Formulation::solid;
    double thickness_mm = 1;      ///< of plane strain and plane stress
    std::vector<Vec3> nodes;      ///< [num_nodes]; z = 0 in a plane
    std::vector<Index> elements;  ///< [num_elements, nodes per element]
    std::vector<Index> region;    ///< [num_elements], indexes materials

    const ElementTable& table() const { return element_table(type); }
    Index num_nodes() const { return static_cast<Index>(nodes.size()); }
    Index num_elements() const { return static_cast<Index>(region.size()); }
    std::span<const Index> nodes_of(Index element) const {
        const auto count = static_cast<std::size_t>(table().num_nodes);
        return {elements.data() + count * element, count};
    }
};

/// The same tetrahedra.
SolidMesh solid_mesh_of(const Mesh& mesh);

/// Throws Error(invalid_argument) naming the first broken rule: array sizes, node and region
/// numbers, an element type that does not go with the formulation, places that are not finite, a
/// plane mesh outside its plane, a negative radius.
void check_mesh(const SolidMesh& mesh);

/// What the displacement gradient at one quadrature point is made of:
///   H = sum_a u_a (outer) gradient_a  +  (sum_a u_a,x hoop_a) e_z (outer) e_z
/// the last term in axisymmetry only, where z is the direction of the circumference.
struct PointGeometry {
    std::array<std::array<double, 3>, most_element_nodes> gradient{};  ///< dN_a/dX, 1/mm
    std::array<double, most_element_nodes> hoop{};                     ///< N_a / radius, 1/mm
    double volume = 0;                                                 ///< mm^3 of the point
};

/// [num_elements, num_points] of the undeformed mesh. Throws Error(invalid_argument) naming the
/// first element whose mapping is degenerate or turned inside out.
std::vector<PointGeometry> point_geometry(const SolidMesh& mesh);

/// For every node itself and the nodes that share an element with it, ascending.
Adjacency node_graph(const SolidMesh& mesh);

}  // namespace palpate
