// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "relaxation_problem.hpp"

namespace palpate {
namespace {

/// Of 1,000 intervals (200 draws, five parameters).
constexpr double fewest = 0.90, most = 0.98;

TEST(Coverage, IntervalsHoldUnderASmootherDiscrepancyThanTheKernels) {
    const Coverage found = coverage_of({OtherNoise::squared_exponential, 2});

    EXPECT_GE(found.all, fewest) << found.share.transpose();
    EXPECT_LE(found.all, most) << found.share.transpose();
}

TEST(Coverage, IntervalsHoldUnderARougherDiscrepancyThanTheKernels) {
    const Coverage found = coverage_of({OtherNoise::autoregressive, 4});

    EXPECT_GE(found.all, fewest) << found.share.transpose();
    EXPECT_LE(found.all, most) << found.share.transpose();
}

/// What no field can learn, and docs/identify.md says: such an error is taken for other parameters.
TEST(Coverage, IntervalsAreTooNarrowUnderAnErrorAsSlowAsTheModel) {
    const Coverage found = coverage_of({OtherNoise::squared_exponential, 8});

    EXPECT_GE(found.all, 0.75) << found.share.transpose();
    EXPECT_LT(found.all, fewest) << found.share.transpose();
}

TEST(Coverage, WithoutADiscrepancyIntervalsMiss) {
    for (const OtherNoise kind : {OtherNoise::squared_exponential, OtherNoise::autoregressive}) {
        CoverageCase broken{kind, 2};
        broken.learns_discrepancy = false;

        EXPECT_LT(coverage_of(broken).all, 0.4);
    }
}

TEST(Coverage, WhereNothingIsWrongIntervalsStayNarrow) {
    CoverageCase clean{OtherNoise::squared_exponential, 2};
    clean.num_draw = 100;
    clean.noise_sd = 0.5;
    clean.discrepancy_sd = 0;
    CoverageCase known = clean;
    known.learns_discrepancy = false;

    const Coverage found = coverage_of(clean), held = coverage_of(known);

    EXPECT_GE(found.all, 0.93) << found.share.transpose();
    EXPECT_LT(found.median_sd, 1.5 * held.median_sd);
}

}  // namespace
}  // namespace palpate
