// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/solid_tables.hpp"

#include <algorithm>
#include <optional>

namespace palpate {
namespace {

const SolidModel& checked(const SolidModel& model) {
    check_model(model);
    return model;
}

AnyLaw law_of(const SolidMaterial& material) {
    std::optional<AnyLaw> found;
    with_material_law<double>(material.law, material.parameters,
                              [&](const auto& law) { found = law; });
    return *found;
}

}  // namespace

AssemblyTables::AssemblyTables(const SolidModel& from, const ElementLoopOptions& options)
    : model(checked(from)),
      geometry(point_geometry(model.mesh)),
      graph(node_graph(model.mesh)),
      parts(element_parts(model.mesh)),
      groups(model, geometry, parts),
      loops(model, options) {
    for (const SolidMaterial& material : model.materials) laws.push_back(law_of(material));
    find_blocks();
}

void AssemblyTables::find_blocks() {
    for (Index e = 0; e < model.mesh.num_elements(); ++e)
        for (const Index a : model.mesh.nodes_of(e))
            for (const Index b : model.mesh.nodes_of(e)) {
                const auto row = graph.items.begin() + graph.offsets[a];
                const auto end = graph.items.begin() + graph.offsets[a + 1];
                // Block (a, b) of the matrix stands in row a, sorted by b.
                blocks.push_back(
                    static_cast<Index>(std::lower_bound(row, end, b) - graph.items.begin()));
            }
}

ElementPoints AssemblyTables::points_of(Index element) const {
    const int points = model.mesh.table().num_points;
    return {model.mesh.nodes_of(element),
            {geometry.data() + static_cast<std::size_t>(element) * points,
             static_cast<std::size_t>(points)}};
}

std::vector<ElementChange> AssemblyTables::changes_of(
    Index element, const std::vector<SolidChange>& changes) const {
    const Index region = model.mesh.region[element];
    std::vector<ElementChange> here;
    for (const SolidChange& change : changes) {
        ElementChange& one = here.emplace_back();
        if (!change.parameters.empty()) one.parameters = change.parameters[region];
        if (!change.factor.empty()) one.factor = change.factor[region];
        if (!change.prestress.empty()) one.prestress = of_element(change.prestress, element);
    }
    return here;
}

}  // namespace palpate
