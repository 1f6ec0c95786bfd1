// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backend/product_choice.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace palpate {
namespace {

const std::vector<Product> all = {Product::assembled, Product::matrix_free, Product::recomputed};

/// Pretends that each product always takes the same time, and counts the runs.
struct FakeClock {
    std::map<Product, double> seconds;
    std::map<Product, int> runs;

    TimeProduct time_product() {
        return [this](Product product) {
            ++runs[product];
            return seconds.at(product);
        };
    }
};

TEST(ProductChoice, TakesTheFastestAndNamesEveryTime) {
    FakeClock clock{
        {{Product::assembled, 2e-3}, {Product::matrix_free, 1e-3}, {Product::recomputed, 1.5e-3}},
        {}};

    const ProductChoice choice = fastest_product(3, all, clock.time_product());

    EXPECT_EQ(choice.product, Product::matrix_free);
    EXPECT_EQ(choice.columns, 3);
    EXPECT_EQ(choice.reason, "assembled 2 ms, matrix-free 1 ms, recomputed 1.5 ms");
    EXPECT_EQ(clock.runs[Product::assembled], 3);
}

TEST(ProductChoice, KeepsThePreferredOneWhenAnotherIsHardlyFaster) {
    FakeClock clock{{{Product::assembled, 1e-3}, {Product::matrix_free, 0.95e-3}}, {}};

    const auto choice = fastest_product(1, std::span(all).first(2), clock.time_product());

    EXPECT_EQ(choice.product, Product::assembled);
}

TEST(ProductChoice, CountsTheBestOfThreeRuns) {
    std::vector<double> times = {9e-3, 1e-3, 5e-3};  // the first run pays for warming up
    std::size_t run = 0;

    const auto choice =
        fastest_product(1, std::span(all).first(1), [&](Product) { return times.at(run++); });

    EXPECT_EQ(choice.reason, "assembled 1 ms");
}

TEST(ProductChoice, GivesAHopelessProductOneRunOnly) {
    FakeClock clock{
        {{Product::assembled, 1e-3}, {Product::matrix_free, 4e-3}, {Product::recomputed, 2e-3}},
        {}};

    fastest_product(1, all, clock.time_product());

    EXPECT_EQ(clock.runs[Product::matrix_free], 1);
    EXPECT_EQ(clock.runs[Product::recomputed], 3);
}

TEST(ProductChoice, PutsNumbersOfColumnsIntoFiveClasses) {
    const std::vector<Index> columns = {1, 2, 4, 5, 8, 9, 16, 17, 32, 1000};
    const std::vector<Index> expected = {1, 4, 4, 8, 8, 16, 16, 32, 32, 32};

    for (std::size_t i = 0; i < columns.size(); ++i)
        EXPECT_EQ(column_class(columns[i]), expected[i]) << columns[i];
}

TEST(ProductChoices, MeasureOncePerSettingAndClassOfColumns) {
    FakeClock clock{{{Product::assembled, 1e-3}}, {}};
    const auto one = std::span(all).first(1);
    ProductChoices choices;

    choices.choose("small", 2, one, clock.time_product());
    choices.choose("small", 3, one, clock.time_product());
    EXPECT_EQ(clock.runs[Product::assembled], 3);
    choices.choose("small", 5, one, clock.time_product());
    choices.choose("large", 2, one, clock.time_product());
    EXPECT_EQ(clock.runs[Product::assembled], 9);

    ASSERT_EQ(choices.choices("small").size(), 2u);
    EXPECT_EQ(choices.choices("small")[0].columns, 2);
    EXPECT_EQ(choices.choices("small")[1].columns, 5);
    EXPECT_TRUE(choices.choices("other").empty());
}

TEST(ProductChoices, UseWhatWasRememberedInsteadOfMeasuring) {
    ProductChoices choices;
    choices.remember("small", {.columns = 16, .product = Product::recomputed, .reason = "noted"});

    const auto choice =
        choices.choose("small", 12, all, [](Product) -> double { throw std::logic_error("ran"); });

    EXPECT_EQ(choice.product, Product::recomputed);
    EXPECT_EQ(choices.find("small", 9)->reason, "noted");
    EXPECT_FALSE(choices.find("small", 1));
}

TEST(ProductChoices, RememberNothingOfAMeasurementThatFailed) {
    ProductChoices choices;
    const auto fails = [](Product) -> double { throw std::runtime_error("device lost"); };

    EXPECT_THROW(choices.choose("small", 1, all, fails), std::runtime_error);

    EXPECT_FALSE(choices.find("small", 1));
}

}  // namespace
}  // namespace palpate
