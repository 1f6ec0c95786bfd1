// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/multi_start.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/base/error.hpp"
#include "toy_problem.hpp"

namespace palpate {
namespace {

/// x^2 = 4, with a prior that likes the positive root.
ToyProblem two_roots() {
    Parameter x = flat_parameter("x", -3);
    x.median = 0.5;
    x.sd = 3;
    return {{x},
            toy_block(Eigen::VectorXd::Constant(3, 4.0), 0.1),
            [](const std::vector<ToyProblem::Number>& v, Index) { return v[0] * v[0]; }};
}

MultiStartOptions eight_starts() {
    MultiStartOptions options;
    options.fit.discrepancy.is_learned = false;
    return options;
}

TEST(MultiStart, FindsTheBetterOfTwoMinima) {
    const ToyProblem problem = two_roots();

    const MultiStart found = fit_from_starts(problem, eight_starts());

    EXPECT_EQ(found.outcomes.size(), 8u);
    EXPECT_EQ(found.num_minimum, 2);
    EXPECT_NEAR(found.best.values[0], 2, 0.02);
}

TEST(MultiStart, OutcomesAreTheSameAfterALineOfJson) {
    StartOutcome outcome;
    outcome.number = 3;
    outcome.start = Eigen::Vector2d(0.1, 1e-300);
    outcome.values = Eigen::Vector2d(1.0 / 3.0, -2e17);
    outcome.objective = -12.345678901234567;
    outcome.ending = Ending::stalled;
    outcome.discrepancies = {{0.1, 2, 1.0 / 7.0}};
    outcome.num_prediction = 17;
    outcome.failure = "a \"quoted\" line\nwith a break";

    const std::string line = json_line(outcome);
    const StartOutcome back = start_outcome_of(line);

    EXPECT_EQ(line.find('\n'), std::string::npos);
    EXPECT_EQ(back.start, outcome.start);
    EXPECT_EQ(back.values, outcome.values);
    EXPECT_EQ(back.objective, outcome.objective);
    EXPECT_EQ(back.ending, outcome.ending);
    EXPECT_EQ(back.discrepancies[0].length_s, outcome.discrepancies[0].length_s);
    EXPECT_EQ(back.failure, outcome.failure);
    EXPECT_EQ(json_line(back), line);
    for (const char* bad : {"", "{}", "[1, 2]", R"({"number": "three"})"})
        EXPECT_THROW(start_outcome_of(bad), Error) << bad;
}

TEST(MultiStart, ResumesWithWhatIsKept) {
    const ToyProblem problem = two_roots();
    std::vector<std::string> lines;
    const auto keep = [&](const StartOutcome& outcome) { lines.push_back(json_line(outcome)); };
    const MultiStart whole = fit_from_starts(problem, eight_starts(), {}, keep);
    const int cost = problem.num_prediction;
    std::vector<StartOutcome> earlier;
    for (int k : {0, 1, 2, 4, 5}) earlier.push_back(start_outcome_of(lines[k]));
    earlier[2].start[0] += 1;  // of another run: must not be used
    lines.clear();
    problem.num_prediction = 0;

    const MultiStart resumed = fit_from_starts(problem, eight_starts(), earlier, keep);

    EXPECT_EQ(lines.size(), 4u);
    EXPECT_LT(problem.num_prediction, 0.8 * cost);
    EXPECT_EQ(resumed.best.values, whole.best.values);
    for (std::size_t k = 0; k < 8; ++k)
        EXPECT_EQ(json_line(resumed.outcomes[k]), json_line(whole.outcomes[k]));
}

TEST(MultiStart, StartsThatFailAreOutcomesAndOnlyFailuresAreAnError) {
    ToyProblem problem = two_roots();
    problem.fails = [](const Eigen::VectorXd& values) { return values[0] < 0; };
    const MultiStart found = fit_from_starts(problem, eight_starts());
    EXPECT_FALSE(found.outcomes[0].is_found());
    EXPECT_NE(found.outcomes[0].failure.find("no equilibrium"), std::string::npos);
    EXPECT_EQ(found.num_minimum, 1);

    problem.fails = [](const Eigen::VectorXd&) { return true; };
    EXPECT_THROW(fit_from_starts(problem, eight_starts()), Error);
}

TEST(MultiStart, GivenStartsTakeThePlaceOfDraws) {
    MultiStartOptions options = eight_starts();
    options.starts = {Eigen::VectorXd::Constant(1, 3.0)};

    const MultiStart found = fit_from_starts(two_roots(), options);

    EXPECT_EQ(found.outcomes.size(), 1u);
    EXPECT_NEAR(found.best.values[0], 2, 0.02);
}

}  // namespace
}  // namespace palpate
