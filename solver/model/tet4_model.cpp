// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/tet4_model.hpp"

#include <algorithm>

#include "solver/materials/registry.hpp"
#include "solver/model/refuse.hpp"

namespace palpate {

SolidModel solid_model_of(const Model& model, const std::string& law) {
    SolidModel solid{solid_mesh_of(model.mesh), {}, model.prescribed};
    for (const LinearElastic& material : model.materials)
        solid.materials.push_back(
            {law, parameters_of_moduli(law, {material.stiffness_kpa, material.poisson_ratio})});
    return solid;
}

bool is_linear_tet4(const SolidModel& model) {
    const auto is_linear = [](const SolidMaterial& material) {
        return material.law == "linear" && material.relaxation.empty();
    };
    return model.mesh.type == ElementType::tet4 && model.contacts.empty() &&
           model.volume == VolumeTreatment::pointwise &&
           std::all_of(model.materials.begin(), model.materials.end(), is_linear);
}

Model tet4_model_of(const SolidModel& model) {
    if (!is_linear_tet4(model))
        refuse("only linear tetrahedra of linear elasticity are a linear model; these are " +
               model.mesh.table().name);
    Model linear{{model.mesh.nodes, {}, model.mesh.region}, {}, model.prescribed};
    linear.mesh.tets.resize(model.mesh.region.size());
    for (Index e = 0; e < model.mesh.num_elements(); ++e)
        std::ranges::copy(model.mesh.nodes_of(e), linear.mesh.tets[e].begin());
    for (const SolidMaterial& material : model.materials)
        linear.materials.push_back({material.parameters[0], material.parameters[1]});
    return linear;
}

}  // namespace palpate
