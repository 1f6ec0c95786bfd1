// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/identifiability.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

ModulusEvidence clear_evidence() {
    ModulusEvidence evidence;
    evidence.interval_kpa = {80, 120};
    evidence.sd_ln = 0.1;
    evidence.seen_sd_ln = 0.1;
    evidence.prior_sd_ln = 1.2;
    return evidence;
}

ModulusEvidence other_evidence(double low_kpa, double high_kpa, double sd_ln) {
    ModulusEvidence evidence = clear_evidence();
    evidence.interval_kpa = {low_kpa, high_kpa};
    evidence.sd_ln = evidence.seen_sd_ln = sd_ln;
    return evidence;
}

bool says(const Judgement& verdict, const char* text) {
    return verdict.reason.find(text) != std::string::npos;
}

TEST(Identifiability, ANarrowIntervalIsRecoveredAndAWideOneWeak) {
    ModulusEvidence evidence = clear_evidence();
    EXPECT_EQ(judge(evidence).verdict, Verdict::recovered);

    evidence.interval_kpa = {50, 120};
    EXPECT_EQ(judge(evidence).verdict, Verdict::weak);
}

TEST(Identifiability, AnOrganThatStandsStillIsNotIdentifiableHoweverSteepItsPosterior) {
    ModulusEvidence evidence = clear_evidence();
    evidence.seen_sd_ln = 1.19;

    const Judgement verdict = judge(evidence);

    EXPECT_EQ(verdict.verdict, Verdict::not_identifiable);
    EXPECT_TRUE(says(verdict, "1.19 against 1.20")) << verdict.reason;
}

TEST(Identifiability, ImagesThatContradictWhatWasAssumedSaySo) {
    ModulusEvidence evidence = clear_evidence();
    evidence.contradiction = {0.4, 4800, true};
    const Judgement sharp = judge(evidence);
    EXPECT_EQ(sharp.verdict, Verdict::weak);
    EXPECT_TRUE(says(sharp, "the search ended at 4800 kPa, far stiffer than was assumed"))
        << sharp.reason;
    EXPECT_TRUE(says(sharp, "a probability of 40 %")) << sharp.reason;
    EXPECT_EQ(told_interval(evidence, sharp, 100), evidence.interval_kpa);

    evidence.sd_ln = 1.1;
    evidence.interval_kpa = {30, 14000};
    const Judgement wide = judge(evidence);
    EXPECT_EQ(wide.verdict, Verdict::not_identifiable);
    EXPECT_FALSE(says(wide, "does not deform enough")) << wide.reason;
    const auto [low, high] = told_interval(evidence, wide, 100);
    EXPECT_NEAR(low, 100 * std::exp(-1.96 * evidence.prior_sd_ln), 1e-9);
    EXPECT_EQ(high, 14000);
}

TEST(Identifiability, ARigidOrganHasALowerBoundOnly) {
    ModulusEvidence evidence = clear_evidence();
    evidence.interval_kpa = {1350, 2500};
    evidence.excludes_stiff = false;

    const Judgement verdict = judge(evidence);

    EXPECT_EQ(verdict.verdict, Verdict::weak);
    EXPECT_TRUE(says(verdict, "only a lower bound is known, 1350 kPa")) << verdict.reason;
    evidence.excludes_soft = false;
    EXPECT_EQ(judge(evidence).verdict, Verdict::not_identifiable);
}

TEST(Identifiability, AnAnswerOfWhichEachHoldsTheOtherChangesNothing) {
    const ModulusEvidence evidence =
        evidence_with({100, clear_evidence()}, {{110, other_evidence(70, 500, 0.5), 110}});

    EXPECT_EQ(evidence.interval_kpa, (std::array{80.0, 120.0}));
    EXPECT_EQ(evidence.sd_ln, 0.1);
    EXPECT_TRUE(evidence.other_kpa.empty());
    EXPECT_EQ(judge(evidence).verdict, Verdict::recovered);
}

TEST(Identifiability, ASecondAnswerIsHeldAndNamed) {
    const ModulusEvidence evidence =
        evidence_with({100, clear_evidence()}, {{190, other_evidence(150, 300, 0.2), 200}});

    EXPECT_EQ(evidence.interval_kpa, (std::array{80.0, 300.0}));
    EXPECT_NEAR(evidence.sd_ln, std::log(300.0 / 80.0) / 3.92, 1e-12);
    const Judgement verdict = judge(evidence);
    EXPECT_EQ(verdict.verdict, Verdict::weak);
    EXPECT_TRUE(says(verdict, "ended at 200 kPa")) << verdict.reason;
}

TEST(Identifiability, AnAnswerThatDoesNotHoldTheFirstIsAnotherOne) {
    const ModulusEvidence evidence =
        evidence_with({100, clear_evidence()}, {{118, other_evidence(110, 126, 0.03), 121}});

    EXPECT_EQ(evidence.interval_kpa, (std::array{80.0, 126.0}));
    EXPECT_EQ(evidence.other_kpa, (std::vector{121.0}));
}

TEST(Identifiability, AnswersAreTheSameInWhateverOrderTheyCome) {
    // The first is inside what the second one widens the interval to.
    const ModulusAnswer near{200, other_evidence(150, 300, 0.2), 200},
        far{400, other_evidence(90, 900, 0.6), 400};

    const ModulusEvidence one = evidence_with({100, clear_evidence()}, {near, far});
    const ModulusEvidence other = evidence_with({100, clear_evidence()}, {far, near});

    EXPECT_EQ(one.interval_kpa, (std::array{80.0, 900.0}));
    EXPECT_EQ(other.interval_kpa, one.interval_kpa);
    EXPECT_EQ(one.other_kpa, (std::vector{200.0, 400.0}));
    EXPECT_EQ(other.other_kpa, one.other_kpa);
    EXPECT_EQ(other.sd_ln, one.sd_ln);
}

TEST(Identifiability, AnswersThatSpanThePriorLeaveNothingIdentified) {
    const ModulusEvidence evidence =
        evidence_with({100, clear_evidence()}, {{1400, other_evidence(500, 5000, 0.6), 1500}});

    const Judgement verdict = judge(evidence);
    EXPECT_EQ(verdict.verdict, Verdict::not_identifiable);
    EXPECT_TRUE(says(verdict, "ended at 1500 kPa")) << verdict.reason;
    EXPECT_FALSE(says(verdict, "does not deform enough")) << verdict.reason;
}

TEST(Identifiability, ModuliThatTradeAreNamed) {
    ModulusEvidence evidence = clear_evidence();
    evidence.partner = "outer zone";
    evidence.partner_correlation = -0.7;
    EXPECT_FALSE(says(judge(evidence), "trades"));

    evidence.partner_correlation = -0.96;

    EXPECT_TRUE(says(judge(evidence), "trades with that of outer zone (correlation -0.96)"));
}

TEST(Identifiability, ARatioIsJudgedByHowMuchTheImagesNarrowWhatWasAllowed) {
    RatioEvidence evidence{0.40, {0.06, 0.06}, RatioLimit::none, {0.25, 0.49}};
    EXPECT_EQ(judge_ratio(evidence).verdict, Verdict::recovered);
    EXPECT_TRUE(says(judge_ratio(evidence), "44 %"));
    evidence.reach = {0.08, 0.08};
    EXPECT_EQ(judge_ratio(evidence).verdict, Verdict::weak);
    evidence.reach = {0.2, 0.2};
    EXPECT_EQ(judge_ratio(evidence).verdict, Verdict::not_identifiable);
    EXPECT_EQ(evidence.interval(), (std::array<double, 2>{0.25, 0.49}));

    // At a limit what lies beyond may fit better still.
    const RatioEvidence at_limit{0.49, {0.06, 0.06}, RatioLimit::highest, {0.25, 0.49}};
    EXPECT_EQ(judge_ratio(at_limit).verdict, Verdict::weak);
    EXPECT_TRUE(says(judge_ratio(at_limit), "an end of what was allowed"));
}

TEST(Identifiability, AnOrganThatCannotBeToldHasTheIntervalOfThePriorAlone) {
    ModulusEvidence evidence = clear_evidence();
    evidence.interval_kpa = {90, 5000};  // of a search whose walls' prior, not its images, moved it
    evidence.prior_sd_ln = 1;
    const Judgement unseen{Verdict::not_identifiable, ""};

    const auto told = told_interval(evidence, unseen, 100);

    EXPECT_NEAR(told[0], 100 * std::exp(-1.96), 1e-9);
    EXPECT_NEAR(told[1], 100 * std::exp(1.96), 1e-9);
}

TEST(Identifiability, AnEndThatTheImagesDoNotGiveIsAtLeastThePriors) {
    ModulusEvidence evidence = clear_evidence();
    evidence.prior_sd_ln = 1;
    evidence.excludes_stiff = false;
    const Judgement bound{Verdict::weak, ""};

    EXPECT_EQ(told_interval(evidence, bound, 100)[0], 80);
    EXPECT_NEAR(told_interval(evidence, bound, 100)[1], 100 * std::exp(1.96), 1e-9);
    evidence.interval_kpa[1] = 5000;
    EXPECT_EQ(told_interval(evidence, bound, 100)[1], 5000);
}

}  // namespace
}  // namespace palpate
