// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

enum class ElementType { tet4, tet10, tri3, tri6, quad4 };

constexpr int most_element_nodes = 10;
constexpr int most_element_points = 4;

/// What loops over elements need to know of one type: shape functions and their derivatives at the
/// quadrature points of the reference element. Nodes are numbered corners first, then the middles
/// of the edges in the order that the type's header gives.
struct ElementTable {
    std::string name;  ///< "tet4"
    int dimension = 3;
    int num_nodes = 0, num_corners = 0, num_points = 0;
    std::vector<double> reference;  ///< [num_nodes, dimension] places of the nodes
    std::vector<double> place;      ///< [num_points, dimension] quadrature points
    std::vector<double> weight;     ///< [num_points], their sum is the reference element's size
    std::vector<double> value;      ///< [num_points, num_nodes] N_a
    std::vector<double> gradient;   ///< [num_points, num_nodes, dimension] dN_a / d xi_j
    /// Nodes of each face (in a plane: of each edge), corners first, so that the normal points
    /// outward (in a plane: to the right of the way along it).
    std::vector<std::vector<int>> faces;
};

/// The table of a type; made once.
const ElementTable& element_table(ElementType type);
/// All types, in the order of the enumeration.
const std::vector<ElementType>& element_types();
/// Throws Error(invalid_argument) naming the types that there are.
ElementType element_type_of(const std::string& name);

/// N_a and dN_a / d xi_j at any place xi [dimension] of a type's reference element, for tests,
/// forces on faces, and probes.
struct ShapeFunctions {
    double value[most_element_nodes] = {};
    double gradient[most_element_nodes][3] = {};
};
ShapeFunctions shape_functions(ElementType type, const double* xi);

}  // namespace palpate
