// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

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

TEST(MaterialLaws, AreTheFiveOfTheDocumentation) {
    std::vector<std::string_view> names;
    for (const MaterialDescription& law : material_laws()) names.push_back(law.name);

    EXPECT_EQ(names, (std::vector<std::string_view>{"linear", "neo-hookean", "neo-hookean-reduced",
                                                    "veronda-westmann", "reduced-polynomial"}));
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

TEST(MaterialCoefficients, AreTheMembersInOrder) {
    EXPECT_EQ(material_coefficients("reduced-polynomial", std::vector<double>{1, 2, 0.5}),
              (std::vector<double>{1, 2, 4, -8}));
}

}  // namespace
}  // namespace palpate
