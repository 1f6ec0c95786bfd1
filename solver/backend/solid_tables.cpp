// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backend/solid_tables.hpp"

#include <algorithm>
#include <cmath>

#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

void refuse_unsupported(const SolidModel& model, const std::string& backend) {
    const auto unsupported = [&](const std::string& what) {
        throw Error(ErrorCode::unsupported,
                    "Back end " + backend + ", make_solid: " + what +
                        " are not implemented on devices; solve such a model on the host.");
    };
    if (model.mesh.formulation == Formulation::plane_stress)
        unsupported("element loops of plane stress");
}

std::vector<double> flat_points(const SolidMesh& mesh, const SolidLayout& layout) {
    std::vector<double> numbers;
    numbers.reserve(mesh.region.size() * layout.num_points * layout.reals_per_point());
    for (const PointGeometry& point : point_geometry(mesh)) {
        for (int a = 0; a < layout.num_nodes; ++a)
            numbers.insert(numbers.end(), point.gradient[a].begin(), point.gradient[a].end());
        numbers.push_back(point.volume);
        if (layout.has_hoop)
            numbers.insert(numbers.end(), point.hoop.begin(),
                           point.hoop.begin() + layout.num_nodes);
    }
    return numbers;
}

std::vector<LawElements> elements_by_law(const SolidModel& model) {
    std::vector<LawElements> lists;
    std::vector<std::size_t> list_of;  // by material
    for (const SolidMaterial& material : model.materials) {
        const std::string_view law = material_law(material.law).name;
        const auto found = std::find_if(lists.begin(), lists.end(),
                                        [&](const LawElements& list) { return list.law == law; });
        list_of.push_back(found - lists.begin());
        if (found == lists.end()) lists.push_back({law, {}});
    }
    for (Index e = 0; e < model.mesh.num_elements(); ++e)
        lists[list_of[model.mesh.region[e]]].elements.push_back(e);
    return lists;
}

std::vector<Index> blocks_of_pairs(const SolidMesh& mesh, const Adjacency& graph) {
    std::vector<Index> blocks;
    blocks.reserve(mesh.elements.size() * mesh.table().num_nodes);
    for (Index e = 0; e < mesh.num_elements(); ++e)
        for (const Index a : mesh.nodes_of(e)) {
            const auto row = graph.items.begin() + graph.offsets[a];
            const auto end = graph.items.begin() + graph.offsets[a + 1];
            for (const Index b : mesh.nodes_of(e))
                blocks.push_back(
                    static_cast<Index>(std::lower_bound(row, end, b) - graph.items.begin()));
        }
    return blocks;
}

}  // namespace

std::size_t SolidTables::most_parameters() const {
    std::size_t most = 0;
    for (const SolidMaterial& material : materials)
        most = std::max(most, material.parameters.size());
    return most;
}

SolidTables solid_tables(const SolidModel& model, const std::string& backend) {
    check_model(model);
    refuse_unsupported(model, backend);
    const SolidMesh& mesh = model.mesh;
    SolidTables tables;
    tables.layout = {mesh.table().num_nodes, mesh.table().num_points,
                     mesh.formulation == Formulation::axisymmetric,
                     model.volume == VolumeTreatment::element_mean};
    tables.num_nodes = mesh.num_nodes();
    tables.elements = mesh.elements;
    tables.region = mesh.region;
    tables.points = flat_points(mesh, tables.layout);
    tables.materials = model.materials;
    tables.laws = elements_by_law(model);
    tables.graph = node_graph(mesh);
    tables.blocks = blocks_of_pairs(mesh, tables.graph);
    return tables;
}

Adjacency places_of(std::span<const Index> values, Index count) {
    Adjacency places;
    places.offsets.assign(count + 1, 0);
    for (const Index value : values) ++places.offsets[value + 1];
    for (Index k = 0; k < count; ++k) places.offsets[k + 1] += places.offsets[k];
    places.items.resize(values.size());
    std::vector<Index> next(places.offsets.begin(), places.offsets.end() - 1);
    for (std::size_t k = 0; k < values.size(); ++k)
        places.items[next[values[k]]++] = static_cast<Index>(k);
    return places;
}

bool is_valid_force(double energy, std::span<const double> force) {
    return std::isfinite(energy) &&
           std::all_of(force.begin(), force.end(), [](double f) { return std::isfinite(f); });
}

std::vector<std::vector<double>> sum_by_material(const SolidTables& tables,
                                                 std::span<const double> parts) {
    const std::size_t most = tables.most_parameters();
    std::vector<std::vector<double>> products;
    for (const SolidMaterial& material : tables.materials)
        products.emplace_back(material.parameters.size(), 0.0);
    for (Index e = 0; e < tables.num_elements(); ++e) {
        std::vector<double>& sums = products[tables.region[e]];
        for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += parts[e * most + k];
    }
    return products;
}

}  // namespace palpate
