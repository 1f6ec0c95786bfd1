// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/more_terms.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "host/apps/identify/experiment_problem.hpp"
#include "host/estimate/fit.hpp"
#include "tests/unit/identify/experiment_fixture.hpp"

namespace palpate {
namespace {

class MoreTermsTest : public ExperimentTest {
protected:
    /// A strip whose stiffness and relaxation are unknown, every term starting at 0.1 and 9 s.
    Experiment relaxing(int num_terms) const {
        std::string terms;
        for (int k = 0; k < num_terms; ++k)
            terms += std::string(k > 0 ? ", " : "") +
                     "{amplitude = {unknown = true, start = 0.1}, time_s = {unknown = true, start "
                     "= 9}}";
        return experiment(strip("\"unknown\"\nrelaxation = [" + terms + "]",
                                force + "gain = {value = 1, sd = 0.01}"));
    }
    static std::map<std::string, double> by_path(const Experiment& of,
                                                 const Eigen::VectorXd& values) {
        std::map<std::string, double> all;
        for (std::size_t k = 0; k < of.paths().size(); ++k)
            all[of.paths()[k]] = values[Eigen::Index(k)];
        return all;
    }
    static Eigen::VectorXd values_of(const Experiment& of,
                                     const std::map<std::string, double>& known) {
        Eigen::VectorXd values = starts_of(of.parameters());
        for (std::size_t k = 0; k < of.paths().size(); ++k)
            values[Eigen::Index(k)] = known.at(of.paths()[k]);
        return values;
    }
};

TEST_F(MoreTermsTest, TheStrongestTermBecomesAFasterAndASlowerOne) {
    const Experiment two = relaxing(2), four = relaxing(4);
    const Eigen::VectorXd values = values_of(two, {{"material[1].stiffness_kpa", 7},
                                                   {"material[1].relaxation[1].amplitude", 0.2},
                                                   {"material[1].relaxation[1].time_s", 0.5},
                                                   {"material[1].relaxation[2].amplitude", 0.6},
                                                   {"material[1].relaxation[2].time_s", 4},
                                                   {"data[1].gain", 1.01}});

    const auto start = by_path(four, start_with_more_terms(two, values, four));

    EXPECT_DOUBLE_EQ(start.at("material[1].stiffness_kpa"), 7);
    EXPECT_DOUBLE_EQ(start.at("data[1].gain"), 1.01);
    double amplitude = 0;
    std::map<double, double> terms;
    for (int k = 1; k <= 4; ++k) {
        const std::string term = "material[1].relaxation[" + std::to_string(k) + "].";
        amplitude += start.at(term + "amplitude");
        terms[start.at(term + "time_s")] = start.at(term + "amplitude");
    }
    EXPECT_NEAR(amplitude, 0.8, 1e-12);  // as stiff at once as before
    // 0.6 at 4 s: 0.3 at 2 and at 8; then the first of those: 0.15 at 1 and at 4
    const std::map<double, double> expected{{0.5, 0.2}, {1, 0.15}, {4, 0.15}, {8, 0.3}};
    ASSERT_EQ(terms.size(), expected.size());
    for (const auto& [time_s, part] : expected)
        EXPECT_NEAR(terms.at(time_s), part, 1e-12) << time_s;
}

TEST_F(MoreTermsTest, WithoutATermToSplitTermsHaveTheirOwnStarts) {
    const Experiment none = relaxing(0), one = relaxing(1);
    const Eigen::VectorXd values =
        values_of(none, {{"material[1].stiffness_kpa", 7}, {"data[1].gain", 1.01}});

    const auto start = by_path(one, start_with_more_terms(none, values, one));

    EXPECT_DOUBLE_EQ(start.at("material[1].stiffness_kpa"), 7);
    EXPECT_DOUBLE_EQ(start.at("material[1].relaxation[1].amplitude"), 0.1);
    EXPECT_DOUBLE_EQ(start.at("material[1].relaxation[1].time_s"), 9);
}

TEST_F(MoreTermsTest, AnotherExperimentsBodyIsAGuess) {
    const Experiment one = relaxing(1), two = relaxing(2);
    const ExperimentProblem simple(one, [](SimulationSettings&) {}, 1, {});
    const ExperimentProblem richer(two, [](SimulationSettings&) {}, 1, {});
    const auto made =
        checked_prediction(simple, starts_of(one.parameters()), PredictedColumns::wanted, nullptr);
    ASSERT_TRUE(made.prediction);
    const Eigen::VectorXd start = start_with_more_terms(one, made.prediction->values, two);

    const auto guess = guess_for(*made.prediction, start);
    ASSERT_TRUE(guess);
    const auto warm = checked_prediction(richer, start, PredictedColumns::wanted, guess.get());
    const auto cold = checked_prediction(richer, start, PredictedColumns::wanted, nullptr);

    ASSERT_TRUE(warm.prediction && cold.prediction);
    const DataBlock &a = warm.prediction->blocks.front(), &b = cold.prediction->blocks.front();
    EXPECT_LT((a.predicted - b.predicted).norm(), 1e-6 * b.predicted.norm());
    EXPECT_LT((a.columns - b.columns).norm(), 1e-5 * b.columns.norm());
}

}  // namespace
}  // namespace palpate
