// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/elements/element.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

class Element : public testing::TestWithParam<ElementType> {
protected:
    const ElementTable& table() const { return element_table(GetParam()); }
    /// A place inside the reference element of every type.
    std::vector<double> inside() const {
        std::vector<double> xi{0.21, 0.17, 0.32};
        xi.resize(table().dimension);
        return xi;
    }
};

INSTANTIATE_TEST_SUITE_P(Types, Element, testing::ValuesIn(element_types()),
                         [](const auto& type) { return element_table(type.param).name; });

TEST_P(Element, ShapeFunctionsAreOneAtTheirOwnNodeAndZeroAtTheOthers) {
    for (int b = 0; b < table().num_nodes; ++b) {
        const ShapeFunctions at =
            shape_functions(GetParam(), &table().reference[b * table().dimension]);
        for (int a = 0; a < table().num_nodes; ++a)
            EXPECT_NEAR(at.value[a], a == b ? 1.0 : 0.0, 1e-14) << a << " at " << b;
    }
}

TEST_P(Element, ShapeFunctionsAddUpToOneAndTheirGradientsToNothing) {
    const auto xi = inside();
    const ShapeFunctions at = shape_functions(GetParam(), xi.data());
    double sum = 0;
    for (int a = 0; a < table().num_nodes; ++a) sum += at.value[a];
    EXPECT_NEAR(sum, 1.0, 1e-14);
    for (int j = 0; j < table().dimension; ++j) {
        double slope = 0;
        for (int a = 0; a < table().num_nodes; ++a) slope += at.gradient[a][j];
        EXPECT_NEAR(slope, 0.0, 1e-14);
    }
}

TEST_P(Element, GradientsAreTheDerivativesOfTheValues) {
    constexpr double step = 1e-6;
    for (int j = 0; j < table().dimension; ++j) {
        auto up = inside(), down = inside();
        up[j] += step;
        down[j] -= step;
        const ShapeFunctions above = shape_functions(GetParam(), up.data());
        const ShapeFunctions below = shape_functions(GetParam(), down.data());
        const ShapeFunctions at = shape_functions(GetParam(), inside().data());
        for (int a = 0; a < table().num_nodes; ++a)
            EXPECT_NEAR((above.value[a] - below.value[a]) / (2 * step), at.gradient[a][j], 1e-9);
    }
}

/// Integral of x^i y^j z^k over a simplex: i! j! k! / (i + j + k + d)!, over [-1, 1]^2 a product.
double exact_integral(const ElementTable& table, const std::array<int, 3>& power) {
    if (table.name == "quad4") {
        double product = 1;
        for (int d = 0; d < 2; ++d) product *= power[d] % 2 ? 0.0 : 2.0 / (power[d] + 1);
        return product;
    }
    double product = 1;
    int total = table.dimension;
    for (const int p : power) {
        product *= std::tgamma(p + 1);
        total += p;
    }
    return product / std::tgamma(total + 1);
}

TEST_P(Element, QuadratureIsExactUpToTheDegreeOfTheStiffness) {
    const bool is_linear_simplex = table().num_nodes == table().dimension + 1;
    const int degree = is_linear_simplex ? 1 : 2;
    for (int i = 0; i <= degree; ++i)
        for (int j = 0; i + j <= degree; ++j)
            for (int k = 0; k <= (table().dimension == 3 ? degree - i - j : 0); ++k) {
                double sum = 0;
                for (int q = 0; q < table().num_points; ++q) {
                    const double* at = &table().place[q * table().dimension];
                    double value = std::pow(at[0], i) * std::pow(at[1], j);
                    if (table().dimension == 3) value *= std::pow(at[2], k);
                    sum += table().weight[q] * value;
                }
                EXPECT_NEAR(sum, exact_integral(table(), {i, j, k}), 1e-14) << i << j << k;
            }
}

TEST_P(Element, IsFoundByItsName) { EXPECT_EQ(element_type_of(table().name), GetParam()); }

TEST(ElementNames, AnUnknownTypeIsRefusedWithThoseThatThereAre) {
    try {
        element_type_of("hex27");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        for (const char* word : {"hex27", "tet4", "tet10", "quad4"})
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word;
    }
}

}  // namespace
}  // namespace palpate
