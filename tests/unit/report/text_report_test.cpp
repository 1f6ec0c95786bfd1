// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/text_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

TEST(TextReport, AlignsItsColumns) {
    const auto lines = lines_of(text_report(synthetic_result()));

    EXPECT_EQ(
        lines[0],
        "Region                     Label  Role        Stiffness kPa  95 % interval  Verdict");
    EXPECT_EQ(
        lines[3],
        "prostate, transition zone      1  tissue               83.2    61.4 to 113  recovered");
    EXPECT_EQ(lines[5],
              "bladder                        3  driven                  -              -  hollow");
    EXPECT_EQ(lines[14],
              "rectum *                   driven        0.860  0.980            0.58   0.11"
              "           3.73   0.25");
}

TEST(TextReport, SaysWhichEndTheImagesDoNotGive) {
    RecoveryResult result = synthetic_result();
    EXPECT_EQ(text_report(result).find("at least"), std::string::npos);

    result.regions[1].seen_ends = {true, false};

    EXPECT_NE(text_report(result).find("\nprostate, transition zone: at least 61.4 kPa (the upper "
                                       "end, 113 kPa, is what was assumed beforehand).\n"),
              std::string::npos);
}

TEST(TextReport, ListsPoissonRatiosThatWereSearched) {
    RecoveryResult result = synthetic_result();
    EXPECT_EQ(text_report(result).find("Poisson"), std::string::npos);

    result.regions[1].poisson_ratio = 0.42;
    result.regions[1].ratio = RatioResult{{0.38, 0.46}, Verdict::recovered, "narrow"};

    const auto lines = lines_of(text_report(result));
    EXPECT_EQ(lines[9], "Region                     Poisson's ratio  95 % interval  Verdict");
    EXPECT_EQ(lines[11], "prostate, transition zone             0.42   0.38 to 0.46  recovered");
}

TEST(TextReport, CountsCharactersNotBytesAndHidesControlCharacters) {
    RecoveryResult r;
    r.regions.push_back({2,
                         "H\xc3\xb6hle\x1b[2J",
                         1,
                         Role::tissue,
                         false,
                         false,
                         0.4,
                         5,
                         {5, 5},
                         0,
                         Verdict::given,
                         ""});
    const auto lines = lines_of(text_report(r));

    EXPECT_EQ(lines[2], "H\xc3\xb6hle?[2J      1  tissue           5.00              -  given");
    EXPECT_EQ(lines[0], "Region     Label  Role    Stiffness kPa  95 % interval  Verdict");
}

TEST(TextReport, EndsWithWarningsAndHowTheSearchEnded) {
    const auto lines = lines_of(text_report(synthetic_result()));

    EXPECT_EQ(lines[lines.size() - 2],
              "Linear solvers, condensing: direct, Eigen 3.4.0 LDLT on host (17,646 degrees of "
              "freedom and 3,402 columns: factorising once on the host is cheapest); solving: "
              "jacobi on pthread-cpu (asked for)");
    EXPECT_EQ(lines[lines.size() - 3], "Warning: rectum is cut by the field of view at both ends");
    EXPECT_EQ(lines.back().substr(0, 43), "The search converged after 9 iterations in ");
}

TEST(TextReport, TellsTheContoursErrorAndWhereElementLoopsRan) {
    RecoveryResult r = synthetic_result();
    r.contours.emplace();
    r.contours->sd_mm = 0.25;
    r.element_loops.emplace().device.device = "host";
    r.element_loops->reason = "a small mesh";
    const std::string text = text_report(r);

    EXPECT_NE(text.find("0.25 mm off"), std::string::npos);
    EXPECT_NE(text.find("\nElement loops: on host (a small mesh)\n"), std::string::npos);
}

TEST(ConvergenceCsv, HasOneLinePerIterationAndQuotesNames) {
    RecoveryResult r = synthetic_result();
    r.regions[1].name = "a \"b\", c";
    r.convergence = {{0, 2.5, NAN, 1, {10, 20}}, {1, 0.5, 0.25, 0, {30}}};

    EXPECT_EQ(convergence_csv(r),
              "iteration,objective,gradient_norm,step,\"stiffness_kpa a \"\"b\"\", c\","
              "\"stiffness_kpa prostate, peripheral zone\"\n0,2.5,,1,10,20\n1,0.5,0.25,0,30,\n");
}

}  // namespace
}  // namespace palpate
