// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

std::string message_of(const std::string& law, const std::vector<double>& values) {
    try {
        check_parameters(material_law(law), values);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        return error.what();
    }
    return "";
}

TEST(MaterialLaws, AreThoseOfTheDocumentation) {
    std::vector<std::string_view> names;
    for (const MaterialDescription& law : material_laws()) names.push_back(law.name);

    EXPECT_EQ(names,
              (std::vector<std::string_view>{"linear", "neo-hookean", "neo-hookean-reduced",
                                             "veronda-westmann", "reduced-polynomial", "yeoh"}));
}

TEST(MaterialLaws, DescribeEveryParameterWithItsUnitInTheName) {
    for (const MaterialDescription& law : material_laws()) {
        std::set<std::string_view> names;
        EXPECT_FALSE(law.sentence.empty());
        for (const MaterialParameter& parameter : law.parameters) {
            EXPECT_TRUE(names.insert(parameter.name).second) << parameter.name;
            EXPECT_FALSE(parameter.meaning.empty());
            EXPECT_EQ(parameter.unit == "kPa",
                      parameter.name.ends_with("_kpa") && !parameter.name.ends_with("_per_kpa"));
            EXPECT_EQ(parameter.unit == "1/kPa", parameter.name.ends_with("_per_kpa"));
        }
    }
}

TEST(MaterialLaws, UnknownNameIsAnErrorThatListsTheKnownOnes) {
    try {
        material_law("rubber");
        FAIL() << "rubber was found";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("reduced-polynomial"), std::string::npos);
    }
}

TEST(CheckParameters, ErrorNamesLawParameterValueAndRange) {
    EXPECT_EQ(message_of("neo-hookean", {10, 0.5}),
              "The material law neo-hookean has poisson_ratio = 0.5, which must be 0 or more and "
              "below 0.5 (Poisson's ratio at small strains).");
    EXPECT_NE(message_of("veronda-westmann", {1, 2}).find("3 parameters, but 2 values"),
              std::string::npos);
}

TEST(CheckParameters, EndsOfRangesAreOpenOrClosedAsTheTableSays) {
    EXPECT_EQ(message_of("neo-hookean", {10, 0}), "");
    EXPECT_NE(message_of("neo-hookean", {10, -1e-9}), "");
    EXPECT_NE(message_of("neo-hookean", {0, 0.3}), "");
    EXPECT_EQ(message_of("linear", {10, -0.99}), "");
    EXPECT_NE(message_of("linear", {10, -1}), "");
    EXPECT_EQ(message_of("reduced-polynomial", {1, 0, 0.1}), "");
    EXPECT_NE(message_of("reduced-polynomial", {1, -1, 0.1}), "");
    for (double odd :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        EXPECT_NE(message_of("linear", {odd, 0.3}), "");
}

TEST(SmallStrainModuli, FollowFromShearAndBulkModulus) {
    // Shear modulus 2 mu = 5, bulk modulus 2 / D1 = 5: E = 9 K G / (3 K + G) = 11.25, nu = 1/8.
    const SmallStrainModuli moduli =
        small_strain_moduli("reduced-polynomial", std::vector<double>{2.5, 1, 0.4});

    EXPECT_DOUBLE_EQ(moduli.stiffness_kpa, 11.25);
    EXPECT_DOUBLE_EQ(moduli.poisson_ratio, 0.125);
}

TEST(ParametersOfModuli, FollowThemInEveryLaw) {
    for (const MaterialDescription& law : material_laws()) {
        const std::vector<double> values = parameters_of_moduli(law.name, {60, 0.45});
        const SmallStrainModuli moduli = small_strain_moduli(law.name, values);

        EXPECT_NEAR(moduli.stiffness_kpa, 60, 1e-9) << law.name;
        EXPECT_NEAR(moduli.poisson_ratio, 0.45, 1e-12) << law.name;
    }
    EXPECT_THROW(parameters_of_moduli("neo-hookean", {60, -0.1}), Error);
    EXPECT_THROW(parameters_of_moduli("rubber", {60, 0.4}), Error);
}

TEST(ParametersOfStiffness, MultiplyStressAndEnergyInEveryLaw) {
    Tensor3<double> h{};
    for (int i = 0; i < 9; ++i) h.m[i] = 0.02 * (i % 4) - 0.03 * (i % 3);
    for (const MaterialDescription& law : material_laws()) {
        std::vector<double> values;
        for (const MaterialParameter& parameter : law.parameters)
            values.push_back(parameter.typical > 0 ? parameter.typical : 0.4);
        const double kpa = small_strain_moduli(law.name, values).stiffness_kpa;
        const std::vector<double> stiffer = parameters_of_stiffness(law.name, values, 7 * kpa);

        const auto energy_and_stress = [&](const std::vector<double>& parameters) {
            std::array<double, 10> numbers{};
            with_material_law<double>(law.name, parameters, [&](const auto& known) {
                const auto state = known.state(h);
                numbers[9] = known.energy(state);
                for (int i = 0; i < 9; ++i) numbers[i] = known.stress(state).m[i];
            });
            return numbers;
        };
        const auto soft = energy_and_stress(values), stiff = energy_and_stress(stiffer);
        EXPECT_GT(soft[9], 0) << law.name;
        for (int i = 0; i < 10; ++i)
            EXPECT_NEAR(stiff[i], 7 * soft[i], 1e-10 * std::abs(stiff[9])) << law.name << " " << i;
    }
}

TEST(MaterialCoefficients, AreTheMembersInOrder) {
    EXPECT_EQ(material_coefficients("reduced-polynomial", std::vector<double>{1, 2, 0.5}),
              (std::vector<double>{1, 2, 4, -8}));
}

}  // namespace
}  // namespace palpate
