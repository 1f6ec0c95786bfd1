// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/apps/study/statistics.hpp"

namespace palpate {
namespace {

Row row_of(const std::string& load, const std::string& contours, double error, double claimed) {
    Row row;
    row.set("anatomy", "usual");
    row.set("load", load);
    row.set("contours", contours);
    row.set("ln_error", error, 6);
    row.set("claimed_sd", claimed, 6);
    row.set("low_kpa", 100 * std::exp(error - 1.96 * claimed), 6);
    row.set("high_kpa", 100 * std::exp(error + 1.96 * claimed), 6);
    row.set_flag("holds_truth", std::abs(error) < 1.96 * claimed);
    return row;
}

TEST(Calibration, OfEachLoadAndKindOfContoursAndOfAll) {
    const auto families = calibration_by_family({row_of("bump", "exact", 0.1, 0.1),
                                                 row_of("bump", "slices:0.5:4", -0.6, 0.2),
                                                 row_of("shift", "slices:0.5:7", 0.2, 0.4)});
    ASSERT_EQ(families.size(), 5u);
    EXPECT_EQ(families[0].family, "load: bump");
    EXPECT_EQ(families[0].count, 2u);
    EXPECT_EQ(families[0].num_holding, 1u);
    EXPECT_NEAR(families[0].bias_ln, -0.25, 1e-6);
    EXPECT_NEAR(families[0].median_abs_ln_error, 0.35, 1e-6);
    EXPECT_NEAR(families[0].error_over_claimed, std::sqrt((1.0 + 9.0) / 2), 1e-6);
    EXPECT_NEAR(families[0].narrowest_factor, std::exp(2 * 1.96 * 0.1), 1e-4);
    EXPECT_EQ(families[3].family, "contours: slices");
    EXPECT_EQ(families[3].count, 2u);
    EXPECT_EQ(families[4].family, "all");
    EXPECT_EQ(families[4].count, 3u);
    EXPECT_EQ(calibration_table(families).lines.size(), 5u);
}

TEST(Calibration, OfOneFamilyIsThatOfAll) {
    const auto families = calibration_by_family({row_of("bump", "exact", 0.1, 0.1)});
    ASSERT_EQ(families.size(), 1u);
    EXPECT_EQ(families[0].family, "all");
}

TEST(DeviationRange, IsThatOfChiSquared) {
    // Ten values: 10 / 20.483 and 10 / 3.247 (tables of chi-squared)
    const auto range = deviation_range(2.0, 10);
    EXPECT_NEAR(range[0], 2 * std::sqrt(10 / 20.483), 1e-3);
    EXPECT_NEAR(range[1], 2 * std::sqrt(10 / 3.247), 1e-3);
    EXPECT_TRUE(std::isinf(deviation_range(1, 0)[1]));
}

}  // namespace
}  // namespace palpate
