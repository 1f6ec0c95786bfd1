// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/tissue_law.hpp"

#include "solver/base/error.hpp"

namespace palpate {

const char* name_of(TissueLaw law) {
    return law == TissueLaw::neo_hookean ? "neo-hookean" : "linear";
}

TissueLaw tissue_law_of(const std::string& name) {
    for (const TissueLaw law : {TissueLaw::linear, TissueLaw::neo_hookean})
        if (name == name_of(law)) return law;
    throw Error(ErrorCode::invalid_argument,
                "there is no tissue law '" + name + "'; choose linear or neo-hookean");
}

SolidModel solid_model_of(const Model& model, TissueLaw law) {
    SolidModel solid;
    solid.mesh = solid_mesh_of(model.mesh);
    for (const LinearElastic& material : model.materials)
        solid.materials.push_back({name_of(law), {material.stiffness_kpa, material.poisson_ratio}});
    solid.prescribed = model.prescribed;
    return solid;
}

}  // namespace palpate
