// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "solver/model/block_matrix.hpp"
#include "solver/model/solid_geometry.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// The elements of one law: those of one launch.
struct LawElements {
    std::string_view law;         ///< as the registry spells it, for ever
    std::vector<Index> elements;  ///< ascending
};

/// A SolidModel as the element loops of back ends read it.
struct SolidTables {
    SolidLayout layout;
    Index num_nodes = 0;
    std::vector<Index> elements;  ///< [num_elements, layout.num_nodes]
    std::vector<Index> region;    ///< [num_elements]
    std::vector<double> points;   ///< [num_elements, num_points, layout.reals_per_point()]
    std::vector<SolidMaterial> materials;
    std::vector<LawElements> laws;
    Adjacency graph;            ///< `node_graph`: the pattern of the stiffness
    std::vector<Index> blocks;  ///< [num_elements, nodes, nodes] which block of `graph` a pair is

    Index num_elements() const { return static_cast<Index>(region.size()); }
    Index num_dofs() const { return 3 * num_nodes; }
    std::size_t most_parameters() const;
};

/// Throws Error(invalid_argument) as `check_model` does, and Error(unsupported) naming `backend`
/// for plane stress, which device loops do not have.
SolidTables solid_tables(const SolidModel& model, const std::string& backend);

/// For every number below `count` the places where `values` has it, ascending: what gathers the
/// results of elements to nodes or blocks in a fixed order.
Adjacency places_of(std::span<const Index> values, Index count);

/// The force and its validity from what the elements store, [num_elements] mN mm.
bool is_valid_force(double energy, std::span<const double> force);

/// Per material the sums of parts [num_elements, most_parameters()], elements ascending.
std::vector<std::vector<double>> sum_by_material(const SolidTables& tables,
                                                 std::span<const double> parts);

}  // namespace palpate
