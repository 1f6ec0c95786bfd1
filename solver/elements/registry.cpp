// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "solver/base/error.hpp"
#include "solver/elements/element_shape.hpp"
#include "solver/elements/quad4.hpp"
#include "solver/elements/tet10.hpp"
#include "solver/elements/tet4.hpp"
#include "solver/elements/tri3.hpp"
#include "solver/elements/tri6.hpp"

namespace palpate {
namespace {

/// One line per element type, in the order of the enumeration.
const std::array<ElementShape, 5>& shapes() {
    static const std::array<ElementShape, 5> list{tet4_shape(), tet10_shape(), tri3_shape(),
                                                  tri6_shape(), quad4_shape()};
    return list;
}

ElementTable table_of(const ElementShape& shape) {
    ElementTable table;
    table.name = shape.name;
    table.dimension = shape.dimension;
    table.num_nodes = shape.num_nodes;
    table.num_corners = shape.num_corners;
    table.faces = shape.faces;
    table.num_points = static_cast<int>(shape.weight.size());
    if (table.num_nodes > most_element_nodes || table.num_points > most_element_points)
        throw Error(ErrorCode::internal, "element type " + table.name + " is larger than arrays");
    table.reference.assign(shape.reference.begin(), shape.reference.end());
    table.place.assign(shape.place.begin(), shape.place.end());
    table.weight.assign(shape.weight.begin(), shape.weight.end());
    for (int q = 0; q < table.num_points; ++q) {
        ShapeFunctions at;
        shape.shapes(&table.place[q * table.dimension], at);
        for (int a = 0; a < table.num_nodes; ++a) {
            table.value.push_back(at.value[a]);
            for (int j = 0; j < table.dimension; ++j) table.gradient.push_back(at.gradient[a][j]);
        }
    }
    return table;
}

std::size_t place_of(ElementType type) { return static_cast<std::size_t>(type); }

}  // namespace

const std::vector<ElementType>& element_types() {
    static const std::vector<ElementType> types{ElementType::tet4, ElementType::tet10,
                                                ElementType::tri3, ElementType::tri6,
                                                ElementType::quad4};
    return types;
}

const ElementTable& element_table(ElementType type) {
    static const std::vector<ElementTable> tables = [] {
        std::vector<ElementTable> list;
        for (const ElementShape& shape : shapes()) list.push_back(table_of(shape));
        return list;
    }();
    return tables[place_of(type)];
}

ElementType element_type_of(const std::string& name) {
    std::string names;
    for (const ElementType type : element_types()) {
        if (name == shapes()[place_of(type)].name) return type;
        names += names.empty() ? "" : ", ";
        names += shapes()[place_of(type)].name;
    }
    throw Error(ErrorCode::invalid_argument,
                "there is no element type '" + name + "'; allowed: " + names);
}

ShapeFunctions shape_functions(ElementType type, const double* xi) {
    ShapeFunctions at;
    shapes()[place_of(type)].shapes(xi, at);
    return at;
}

}  // namespace palpate
