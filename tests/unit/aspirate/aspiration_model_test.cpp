// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/model/aspiration_model.hpp"

#include <gtest/gtest.h>

#include <type_traits>

#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

SimulationSettings body_of(const TissueText& tissue) {
    AspirationBody body;
    body.hole_diameter_mm = {.value = 10};
    body.edge_radius_mm = {.value = 0.2};
    body.depth_mm = {.value = 16};
    body.outer_diameter_mm = 20;
    body.width_mm = 20;
    body.rest = cap_surface(1, 5, 0.2);
    body.tissue = tissue;
    body.kappa_kpa = 2000;
    body.contact_kpa_per_mm = 1000;
    body.peak_kpa = 10;
    body.steps.time_s = {1, 2};
    body.steps.share = {0.5, 1};
    return parse_simulation(aspiration_model_text(body), "m.toml", {});
}

/// K in rest, kPa.
double bulk_modulus_of(const SimulationSettings& settings) {
    const SolidMaterial& material = settings.materials.at(0).material;
    double kpa = 0;
    with_material_law<double>(material.law, material.parameters, [&](const auto& law) {
        kpa = bulk_modulus(std::decay_t<decltype(law)>::small_strain(material.parameters.data()));
    });
    return kpa;
}

const TissueText laws[] = {{"veronda-westmann", {{"mu_kpa", "1"}, {"gamma", "4"}}, {}},
                           {"neo-hookean-reduced", {{"mu_kpa", "1"}}, {}},
                           {"reduced-polynomial", {{"c1_kpa", "1"}, {"c2_kpa", "2"}}, {}}};

TEST(AspirationModel, HasTheBulkModulusOfItsBodyWithAnyLaw) {
    for (const TissueText& law : laws) {
        SCOPED_TRACE(law.law);
        EXPECT_NEAR(bulk_modulus_of(body_of(law)), 2000, 1);
    }
}

TEST(AspirationModel, ALimitMakesTissueEasierToCompressAndNeverHarder) {
    for (const TissueText& law : laws) {
        SCOPED_TRACE(law.law);
        SimulationSettings settings = body_of(law);
        limit_bulk_modulus(3000, settings);
        EXPECT_NEAR(bulk_modulus_of(settings), 2000, 1);
        limit_bulk_modulus(200, settings);
        EXPECT_NEAR(bulk_modulus_of(settings), 200, 1);
    }
}

}  // namespace
}  // namespace palpate
