// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/model.hpp"

#include <cmath>

#include "solver/mesh/spatial_order.hpp"
#include "solver/model/refuse.hpp"

namespace palpate {
namespace {

void check_sizes(const Model& model) {
    const Mesh& mesh = model.mesh;
    if (mesh.nodes.empty() || mesh.tets.empty())
        refuse("The model has no elements; give a mesh with at least one tetrahedron.");
    if (mesh.region.size() != mesh.tets.size())
        refuse("The mesh has " + std::to_string(mesh.region.size()) + " region numbers for " +
               std::to_string(mesh.tets.size()) + " tetrahedra; give one per tetrahedron.");
    if (model.prescribed.size() != 3 * mesh.nodes.size())
        refuse("The model has " + std::to_string(model.prescribed.size()) +
               " prescribed flags for " + std::to_string(mesh.nodes.size()) +
               " nodes; give three per node.");
}

void check_materials(const Model& model) {
    for (std::size_t r = 0; r < model.materials.size(); ++r) {
        const LinearElastic& material = model.materials[r];
        if (!(material.stiffness_kpa > 0) || !std::isfinite(material.stiffness_kpa))
            refuse("Region " + std::to_string(r) + " has stiffness " +
                   std::to_string(material.stiffness_kpa) + " kPa; it must be above 0.");
        if (!(material.poisson_ratio > -1 && material.poisson_ratio < 0.5))
            refuse("Region " + std::to_string(r) + " has Poisson's ratio " +
                   std::to_string(material.poisson_ratio) + "; it must be above -1 and below 0.5.");
    }
}

void check_tet(const Model& model, Index t) {
    const Mesh& mesh = model.mesh;
    for (Index node : mesh.tets[t])
        if (node < 0 || node >= mesh.num_nodes())
            refuse("Tetrahedron " + std::to_string(t) + " names node " + std::to_string(node) +
                   ", but the mesh has nodes 0 to " + std::to_string(mesh.num_nodes() - 1) + ".");
    const Index region = mesh.region[t];
    if (region < 0 || region >= static_cast<Index>(model.materials.size()))
        refuse("Tetrahedron " + std::to_string(t) + " is in region " + std::to_string(region) +
               ", but there are " + std::to_string(model.materials.size()) + " materials.");
    if (!(tet_volume(mesh, t) > 0))
        refuse("Tetrahedron " + std::to_string(t) + " has volume " +
               std::to_string(tet_volume(mesh, t)) +
               " mm^3; it must be positive: remesh, or swap two of its nodes if it is inverted.");
}

}  // namespace

void check_model(const Model& model) {
    check_sizes(model);
    check_materials(model);
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        if (!model.mesh.nodes[n].allFinite())
            refuse("Node " + std::to_string(n) + " has a coordinate that is not finite.");
    for (Index t = 0; t < model.mesh.num_tets(); ++t) check_tet(model, t);
}

Model renumbered(const Model& model, const std::vector<Index>& order) {
    check_model(model);
    Model result;
    result.mesh = renumbered(model.mesh, order);
    result.materials = model.materials;
    result.prescribed.reserve(model.prescribed.size());
    for (Index node : order)
        for (Index c = 0; c < 3; ++c) result.prescribed.push_back(model.prescribed[3 * node + c]);
    return result;
}

}  // namespace palpate
