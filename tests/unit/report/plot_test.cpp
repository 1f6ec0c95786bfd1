// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/plot.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/apps/recover/report/report_plots.hpp"
#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

TEST(Ticks, AreRoundValuesInsideTheAxis) {
    EXPECT_EQ(tick_values({0, 9, false, ""}), (std::vector<double>{0, 2, 4, 6, 8}));
    EXPECT_EQ(tick_values({8, 260, true, ""}), (std::vector<double>{10, 20, 50, 100, 200}));
    EXPECT_EQ(tick_values({0.5, 20000, true, ""}), (std::vector<double>{1, 10, 100, 1000, 10000}));
}

TEST(Plot, PutsPointsWhereTheAxesSayAndSkipsWhatCannotBeDrawn) {
    Plot plot("p", 172, 164, {1, 100, true, "x"}, {0, 10, false, "y"});

    plot.curve({1, 10, -5, 100}, {0, 5, 5, NAN}, "red", false);

    // Left 58, right 14, top 20, bottom 44: a square of 100.
    EXPECT_NE(plot.svg("t").find("d='M58.0 120.0L108.0 70.0'"), std::string::npos) << plot.svg("t");
}

TEST(Plot, DrawsMarksBarsAndGuidesWhereTheAxesSay) {
    Plot plot("p", 172, 164, {1, 100, true, "x"}, {0, 10, false, "y"});

    plot.points({10, 0}, {5, 5}, "red", false);
    plot.points({10}, {10}, "red", true);
    plot.bars({10, 10}, {2, NAN}, {8, 9}, "blue");
    plot.guide({1, 100}, {0, 10}, "equal <");

    const std::string svg = plot.svg("t");
    EXPECT_NE(svg.find("<circle class='mark' cx='108.0' cy='70.0'"), std::string::npos) << svg;
    EXPECT_NE(svg.find("<circle class='ring' cx='108.0' cy='20.0'"), std::string::npos) << svg;
    EXPECT_NE(svg.find("d='M108.0 100.0V40.0"), std::string::npos) << svg;
    EXPECT_NE(svg.find("d='M58.0 120.0L158.0 20.0'"), std::string::npos) << svg;
    EXPECT_NE(svg.find("equal &lt;"), std::string::npos) << svg;
    EXPECT_EQ(svg.find("nan"), std::string::npos) << svg;
}

TEST(ReportPlots, DrawOneProfileForEachUnknownModulus) {
    const std::string figures = profile_figures(synthetic_result());

    EXPECT_NE(figures.find("profile-2"), std::string::npos);
    EXPECT_NE(figures.find("profile-3"), std::string::npos);
    EXPECT_NE(figures.find("83.2 kPa"), std::string::npos);
}

TEST(ReportPlots, DrawNoNumberOfAModulusThatCannotBeTold) {
    RecoveryResult r = synthetic_result();
    const std::string told = interval_figure(r);
    for (RegionResult& region : r.regions)
        if (region.unknown) region.verdict = Verdict::not_identifiable;

    const std::string intervals = interval_figure(r), profiles = profile_figures(r);

    EXPECT_NE(told.find("<circle"), std::string::npos) << told;
    EXPECT_EQ(intervals.find("<circle"), std::string::npos) << intervals;
    EXPECT_NE(intervals.find("class='whisker'"), std::string::npos) << intervals;
    EXPECT_EQ(profiles.find("83.2 kPa"), std::string::npos) << profiles;
    EXPECT_NE(profiles.find("Shade: what the modulus may be"), std::string::npos) << profiles;
}

TEST(ReportPlots, SurviveNumbersThatAreNotFinite) {
    RecoveryResult r = synthetic_result();
    r.regions[1].stiffness_kpa = NAN;
    r.regions[2].interval_kpa = {0, INFINITY};
    r.profiles[0].objective.assign(21, NAN);
    r.profiles[1].stiffness_kpa[0] = 0;
    for (IterationRecord& i : r.convergence) i.objective = NAN;

    for (const std::string& figures :
         {interval_figure(r), profile_figures(r), convergence_figures(r)}) {
        EXPECT_EQ(figures.find("nan"), std::string::npos) << figures;
        EXPECT_EQ(figures.find("inf"), std::string::npos) << figures;
    }
}

TEST(ReportPlots, AreEmptyWithoutData) {
    EXPECT_EQ(interval_figure({}), "");
    EXPECT_EQ(profile_figures({}), "");
    EXPECT_EQ(convergence_figures({}), "");
}

}  // namespace
}  // namespace palpate
