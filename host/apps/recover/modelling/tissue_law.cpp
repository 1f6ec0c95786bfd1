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

SolidModel with_law(SolidModel model, TissueLaw law) {
    for (SolidMaterial& material : model.materials) material.law = name_of(law);
    return model;
}

double stiffness_kpa(const SolidModel& model, Index region) {
    return model.materials[region].parameters[0];
}

double poisson_ratio(const SolidModel& model, Index region) {
    return model.materials[region].parameters[1];
}

void set_stiffness(SolidModel& model, Index region, double kpa) {
    model.materials[region].parameters[0] = kpa;
}

void set_poisson_ratio(SolidModel& model, Index region, double ratio) {
    model.materials[region].parameters[1] = ratio;
}

std::vector<double> moduli_of(const SolidModel& model) {
    std::vector<double> moduli;
    for (const SolidMaterial& material : model.materials) moduli.push_back(material.parameters[0]);
    return moduli;
}

}  // namespace palpate
