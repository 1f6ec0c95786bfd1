// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/accuracy.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Accuracy, SummarisesErrorsAndIntervals) {
    const std::vector<Estimate> estimates{{100, 110, {90, 130}, Verdict::recovered},
                                          {100, 80, {70, 90}, Verdict::recovered},
                                          {100, 101, {0, 0}}};

    const Accuracy accuracy = accuracy_of("all", estimates);

    EXPECT_EQ(accuracy.count, 3u);
    EXPECT_NEAR(accuracy.median_abs_error_percent, 10, 1e-9);
    EXPECT_NEAR(accuracy.mean_signed_error_percent, -3, 1e-9);
    EXPECT_NEAR(accuracy.worst_abs_error_percent, 20, 1e-9);
    EXPECT_EQ(accuracy.num_intervals, 2u);
    EXPECT_EQ(accuracy.num_holding, 1u);
}

TEST(Accuracy, IsGroupedByTrueStiffnessWithoutEmptyGroups) {
    const auto groups = accuracy_by_group(estimates_of(published_recovery()));

    ASSERT_EQ(groups.size(), 3u);  // no published value between 150 and 200 kPa
    EXPECT_EQ(groups[0].count, 6u);
    EXPECT_EQ(groups[1].count, 8u);
    EXPECT_EQ(groups[2].count, 14u);
    EXPECT_LT(groups[0].median_abs_error_percent, 4);
    EXPECT_GT(groups[1].median_abs_error_percent, 20);
}

TEST(Accuracy, TakesTheExpectedValueWhereARowNamesOne) {
    Row row;
    row.set("true_kpa", 100, 1);
    row.set("expected_kpa", 50, 1);
    row.set("found_kpa", 55, 1);
    row.set("low_kpa", 45, 1);
    row.set("high_kpa", 60, 1);

    const Estimate estimate = estimates_of(std::vector{row}).at(0);

    EXPECT_NEAR(estimate.error_percent(), 10, 1e-9);
    EXPECT_TRUE(estimate.holds_truth());
}

}  // namespace
}  // namespace palpate
