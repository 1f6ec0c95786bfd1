// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/findings.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

TEST(Numbers, CountsHaveACommaEveryThreeDigits) {
    EXPECT_EQ(grouped(0), "0");
    EXPECT_EQ(grouped(999), "999");
    EXPECT_EQ(grouped(1000), "1,000");
    EXPECT_EQ(grouped(100000), "100,000");
    EXPECT_EQ(grouped(1234567), "1,234,567");
}

TEST(Significant, KeepsThreeDigitsWithoutExponentInTheUsualRange) {
    EXPECT_EQ(significant(83.24), "83.2");
    EXPECT_EQ(significant(9.999), "10.0");
    EXPECT_EQ(significant(1234.5), "1230");
    EXPECT_EQ(significant(0.01234), "0.0123");
    EXPECT_EQ(significant(-83.24), "-83.2");
    EXPECT_EQ(significant(0), "0");
    EXPECT_EQ(significant(1.5e7), "1.50e+07");
    EXPECT_EQ(significant(NAN), "n/a");
}

TEST(Findings, SayStiffnessIntervalRatioAndVerdict) {
    const RecoveryResult result = synthetic_result();

    EXPECT_EQ(finding_sentence(result, result.regions[1]),
              "prostate, transition zone: 83.2 kPa (95 % interval 61.4 to 113 kPa), 8.32 times "
              "background (10.0 kPa, given). Verdict: recovered. The interval is narrower than a "
              "factor of 2.");
}

TEST(Findings, SayWhichEndTheImagesDoNotGive) {
    RecoveryResult result = synthetic_result();
    RegionResult& prostate = result.regions[1];
    EXPECT_EQ(bound_text(prostate), "");
    prostate.verdict = Verdict::weak;

    prostate.seen_ends = {true, false};
    EXPECT_EQ(bound_text(prostate),
              "at least 61.4 kPa (the upper end, 113 kPa, is what was assumed beforehand)");
    EXPECT_EQ(finding_sentence(result, prostate).find("prostate, transition zone: at least 61.4"),
              0u);

    prostate.seen_ends = {false, true};
    EXPECT_EQ(bound_text(prostate),
              "at most 113 kPa (the lower end, 61.4 kPa, is what was assumed beforehand)");
    prostate.seen_ends = {false, false};
    EXPECT_EQ(bound_text(prostate), "");
}

TEST(Findings, GiveNoNumberForWhatCannotBeTold) {
    RecoveryResult result = synthetic_result();
    result.regions[1].verdict = Verdict::not_identifiable;
    result.regions[1].reason = "Its whole surface carries unknown forces";

    const std::string text = finding_sentence(result, result.regions[1]);

    EXPECT_EQ(text.find("83.2"), std::string::npos) << text;
    EXPECT_NE(text.find("cannot be told"), std::string::npos) << text;
    EXPECT_NE(text.find("unknown forces."), std::string::npos) << text;
}

TEST(Findings, SayLoudlyThatTheSearchDidNotConverge) {
    RecoveryResult result = synthetic_result();
    result.termination = {false, "the limit of 50 iterations was reached", 50};

    EXPECT_NE(termination_sentence(result).find("did NOT converge after 50 iterations"),
              std::string::npos);
    EXPECT_EQ(summary_sentences(result).size(), 5u);
}

TEST(Findings, SayHowFarContoursAreOffAndWhoSaidSo) {
    RecoveryResult result = synthetic_result();
    EXPECT_NE(contours_sentence(result).find("seem to be 0.42 mm off"), std::string::npos);
    result.contours->is_given = true;
    EXPECT_NE(contours_sentence(result).find("were given to be 0.42 mm off"), std::string::npos);
    result.contours->images = 1;
    EXPECT_NE(contours_sentence(result).find("of the reference"), std::string::npos);
    result.contours->sd_mm = 0;
    EXPECT_NE(contours_sentence(result).find("given to be exact"), std::string::npos);
    result.contours.reset();
    EXPECT_EQ(contours_sentence(result), "");
}

TEST(Findings, TotalIsTheSumOfTheStages) {
    EXPECT_NEAR(total_seconds(synthetic_result()), 84.7, 1e-9);
}

}  // namespace
}  // namespace palpate
