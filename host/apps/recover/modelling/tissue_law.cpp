// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/tissue_law.hpp"

#include <utility>

#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

SmallStrainModuli moduli_of(const SolidMaterial& material) {
    return small_strain_moduli(material.law, material.parameters);
}

}  // namespace

TissueLaw tissue_law_of(const std::string& name) { return {std::string(material_law(name).name)}; }

std::vector<std::string> tissue_law_names() {
    std::vector<std::string> names;
    for (const MaterialDescription& law : material_laws()) names.emplace_back(law.name);
    return names;
}

std::string tissue_laws_text() {
    std::string text = "linear (small strains)";
    for (const std::string& name : tissue_law_names())
        if (!TissueLaw{name}.is_linear()) text += ", " + name;
    return text + " (large deformation)";
}

SolidMaterial with_law(SolidMaterial material, const TissueLaw& law) {
    material.parameters = parameters_of_moduli(law.name, moduli_of(material));
    material.law = law.name;
    return material;
}

SolidModel with_law(SolidModel model, const TissueLaw& law) {
    for (SolidMaterial& material : model.materials) material = with_law(std::move(material), law);
    return model;
}

double stiffness_kpa(const SolidModel& model, Index region) {
    return moduli_of(model.materials[region]).stiffness_kpa;
}

double poisson_ratio(const SolidModel& model, Index region) {
    return moduli_of(model.materials[region]).poisson_ratio;
}

void set_stiffness(SolidModel& model, Index region, double kpa) {
    SolidMaterial& material = model.materials[region];
    material.parameters = parameters_of_stiffness(material.law, material.parameters, kpa);
}

void set_poisson_ratio(SolidModel& model, Index region, double ratio) {
    SolidMaterial& material = model.materials[region];
    material.parameters =
        parameters_of_moduli(material.law, {moduli_of(material).stiffness_kpa, ratio});
}

std::vector<double> moduli_of(const SolidModel& model) {
    std::vector<double> moduli;
    for (const SolidMaterial& material : model.materials)
        moduli.push_back(moduli_of(material).stiffness_kpa);
    return moduli;
}

}  // namespace palpate
