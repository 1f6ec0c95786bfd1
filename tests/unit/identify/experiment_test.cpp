// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/experiment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/apps/identify/experiment_problem.hpp"
#include "host/apps/identify/planned_problem.hpp"
#include "host/apps/identify/resolution.hpp"
#include "host/estimate/fit.hpp"
#include "host/estimate/identified.hpp"
#include "tests/unit/identify/experiment_fixture.hpp"
#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

TEST_F(ExperimentTest, ListsWhatIsUnknownAndNuisancesInTheirPlaces) {
    const Experiment found =
        experiment(strip("\"unknown\"", force + "gain = {value = 1, sd = 0.01}"));

    EXPECT_EQ(found.title(), "Strip");
    EXPECT_EQ(found.paths(),
              (std::vector<std::string>{"material[1].stiffness_kpa", "data[1].gain"}));
    EXPECT_FALSE(found.parameters()[0].is_nuisance);
    EXPECT_TRUE(found.parameters()[1].is_nuisance);
    EXPECT_TRUE(found.moves_body(0));
    EXPECT_FALSE(found.moves_body(1));
    const ExperimentSetup setup = found.at(Eigen::Vector2d(12, 1.1));
    EXPECT_EQ(setup.materials[0].material.parameters[0], 12);
}

TEST_F(ExperimentTest, MistakesAreRefusedWithASentence) {
    expect_refused([&] { experiment(strip("10", force)); }, {"nothing is \"unknown\""});
    const std::string model = strip("\"unknown\"", "");
    expect_refused([&] { experiment(model.substr(0, model.find("[[data]]"))); }, {"[[data]]"});
    expect_refused(
        [&] { experiment(strip("\"unknown\"", "kind = \"forces\"\nfile = \"pull.csv\"")); },
        {"kind", "\"force\""});
    expect_refused([&] { experiment(strip("\"unknown\"", force + "colour = 3")); }, {"colour"});
    expect_refused(
        [&] {
            experiment(
                "[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = \"unknown\"\npoisson_ratio = "
                "0.3\n[[data]]\n" +
                force);
        },
        {"[mesh]"});
    expect_refused(
        [&] {
            experiment(
                strip("\"unknown\"", "kind = \"force\"\nfile = \"none.csv\"\non = \"right\""));
        },
        {"none.csv"}, ErrorCode::input_unreadable);
}

TEST_F(ExperimentTest, WhatDoesNotFitTheModelIsRefusedWhenItIsRead) {
    const auto predict = [&](const std::string& data) {
        const Experiment found = experiment(strip("\"unknown\"", data));
        ExperimentProblem(found, [](SimulationSettings&) {}, 1, {})
            .predict(starts_of(found.parameters()), PredictedColumns::none, nullptr);
    };
    expect_refused(
        [&] {
            predict(
                "kind = \"force\"\nfile = \"pull.csv\"\non = \"top\"\ncomponent = "
                "\"x\"\nsd_mn = 1");
        },
        {"on", "left, right"});
    write("late.csv", "time_s,force_mn\n3,1\n");
    expect_refused(
        [&] {
            predict(
                "kind = \"force\"\nfile = \"late.csv\"\non = \"left\"\ncomponent "
                "= \"x\"\nsd_mn = 1");
        },
        {"3 s", "end at 1 s"});
    write("out.csv", "x_mm,y_mm,ux_mm\n50,1,1\n");
    expect_refused([&] { predict("kind = \"points\"\nfile = \"out.csv\"\nsd_mm = 1"); },
                   {"out.csv, line 2", "not in the body"});
}

TEST_F(ExperimentTest, ColumnsAreTheDerivativesOfWhatIsPredicted) {
    write("points.csv", "x_mm,y_mm,ux_mm,uy_mm\n5,1,0,0\n7.3,2.5,0,0\n");
    const Experiment found = experiment(
        strip("\"unknown\"", force + "gain = {value = 1, sd = 0.01}\ndelay_s = {value = 0, sd = "
                                     "0.02}\n[[data]]\nkind = \"points\"\nfile = "
                                     "\"points.csv\"\nsd_mm = 0.1\n"));
    const ExperimentProblem problem(found, [](SimulationSettings&) {}, 2, {});
    const Eigen::Vector3d values(12, 1.05, 0.01);
    const auto centre = problem.predict(values, PredictedColumns::wanted, nullptr).prediction;

    for (int k = 0; k < 3; ++k) {
        const double h = k == 0 ? 0.05 : 1e-3;
        for (std::size_t b = 0; b < centre->blocks.size(); ++b) {
            const auto at = [&](double sign) {
                Eigen::Vector3d moved = values;
                moved[k] += sign * h;
                return problem.predict(moved, PredictedColumns::none, nullptr)
                    .prediction->blocks[b]
                    .predicted;
            };
            const Eigen::VectorXd slope = (at(1) - at(-1)) / (2 * h);
            EXPECT_LT((centre->blocks[b].columns.col(k) - slope).norm(), 2e-4 * slope.norm() + 1e-9)
                << "block " << b << ", parameter " << k;
        }
    }
    // Force in equilibrium is proportional to the one modulus, and to the gain.
    const DataBlock& block = centre->blocks[0];
    EXPECT_LT((block.columns.col(0) * 12 - block.predicted).norm(), 1e-6 * block.predicted.norm());
    EXPECT_LT((block.columns.col(1) * 1.05 - block.predicted).norm(),
              1e-6 * block.predicted.norm());
}

TEST_F(ExperimentTest, ColumnsOfLoadsComeWithOneSimulation) {
    write("points.csv", "time_s,x_mm,y_mm,ux_mm,uy_mm\n1,3,2,0,0\n2,8,3,0,0\n2,5,1,0,0\n");
    const Experiment found = experiment(
        "[mesh]\nformulation = \"plane-strain\"\nrectangle = {size_mm = [10, 4], divisions = [8, "
        "4]}\n[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = \"unknown\"\npoisson_ratio = "
        "0.3\n[[fix]]\nwhere = {side = \"x-min\"}\n"
        "[[move]]\nwhere = {side = \"x-max\"}\nx_mm = {value = 0.6, sd = 0.1}\ny_mm = 0\n"
        "column = \"pull\"\n"
        "[[pressure]]\nkpa = {value = 1.5, sd = 0.3}\nfollows = true\ncolumn = \"push\"\n"
        "where = {side = \"y-max\"}\n"
        "[[traction]]\nkpa = [{value = 0.4, sd = 0.1}, 0.2]\nwhere = {side = \"y-min\"}\n"
        "column = \"push\"\n"
        "[[force]]\ntotal_mn = [0, {value = 8, sd = 1}]\nwhere = {side = \"y-max\"}\n"
        "column = \"push\"\n"
        "[[obstacle]]\nshape = \"plane\"\nplace_mm = [0, 4.1, 0]\ndirection = [0, -1, 0]\n"
        "motion_mm = [0, {value = -0.3, sd = 0.1}, 0]\ncolumn = \"push\"\n"
        "where = {side = \"y-max\"}\n"
        "[history]\ntime_s = [1, 2]\npull = [0.5, 1]\npush = [1, 0.7]\n"
        "[newton]\nrelative_tolerance = 1e-12\n"
        "[[data]]\nkind = \"points\"\nfile = \"points.csv\"\nsd_mm = 0.1\n");
    ASSERT_EQ(found.parameters().size(), 6u);
    const ExperimentProblem problem(found, [](SimulationSettings&) {}, 2, {});
    const Eigen::VectorXd values = starts_of(found.parameters());
    const auto centre = problem.predict(values, PredictedColumns::wanted, nullptr).prediction;
    EXPECT_EQ(problem.num_simulation(), 1);

    for (Eigen::Index k = 0; k < values.size(); ++k) {
        const auto at = [&](double by) {
            Eigen::VectorXd moved = values;
            moved[k] += by;
            return problem.predict(moved, PredictedColumns::none, nullptr)
                .prediction->blocks[0]
                .predicted;
        };
        const double h = 1e-4 * std::abs(values[k]);
        const Eigen::VectorXd slope = (at(h) - at(-h)) / (2 * h);
        EXPECT_GT(slope.norm(), 1e-6) << found.paths()[k];
        EXPECT_LT((centre->blocks[0].columns.col(k) - slope).norm(), 1e-5 * slope.norm())
            << found.paths()[k];
    }
}

/// A graded body under suction, whose cells can be doubled.
const std::string sucked =
    "[mesh]\nformulation = \"axisymmetric\"\nvolume = \"element-mean\"\ngraded = {width_mm = 20, "
    "depth_mm = 16, edge_mm = 5, columns_inside = 8, columns_outside = 4, rows = 8}\n"
    "[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = {unknown = true, start = 10}\n"
    "poisson_ratio = 0.4\n[[fix]]\nwhere = {side = \"y-min\"}\n[[pressure]]\nwhere = {point_array "
    "= "
    "\"surface\"}\nkpa = -1\ncolumn = \"share\"\n[history]\ntime_s = [1, 2, 3, 4]\nshare = [0.2, "
    "0.5, 0.8, 1]\n[[data]]\nkind = \"points\"\nfile = \"points.csv\"\nsd_mm = 0.1\n";

double distance_of_states(const Prediction& a, const Prediction& b) {
    const auto& from = dynamic_cast<const ExperimentPrediction&>(a).simulation->states;
    const auto& to = dynamic_cast<const ExperimentPrediction&>(b).simulation->states;
    EXPECT_EQ(from.size(), to.size());
    double sum = 0;
    for (std::size_t s = 0; s < to.size(); ++s)
        sum += (from[s].displacement - to[s].displacement).norm();
    return sum;
}

TEST_F(ExperimentTest, GuessesMovedByAnotherModelAreNearerThanEitherAlone) {
    write("points.csv", "x_mm,y_mm,ux_mm,uy_mm\n0,-1,0,0\n");
    const Experiment found = experiment(sucked);
    const ExperimentProblem exact(found, [](SimulationSettings&) {}, 1, {});
    const ExperimentProblem other(
        found, [](SimulationSettings& settings) { double_cells(settings); }, 1, {});
    const auto predict = [](const ExperimentProblem& problem, double stiffness) {
        return problem
            .predict(Eigen::VectorXd::Constant(1, stiffness), PredictedColumns::none, nullptr)
            .prediction;
    };
    const auto before = predict(exact, 10), answer = predict(exact, 8);
    const auto guess =
        moved_guess(*before, *predict(other, 10), *predict(other, 8), answer->values);
    ASSERT_TRUE(guess);
    EXPECT_LT(distance_of_states(*guess, *answer), 0.2 * distance_of_states(*before, *answer));
    // It begins another one, and is never taken for it.
    const int simulations = exact.num_simulation();
    const auto anew = exact.predict(answer->values, PredictedColumns::none, guess.get()).prediction;
    EXPECT_EQ(exact.num_simulation(), simulations + 1);
    EXPECT_LT((anew->blocks[0].predicted - answer->blocks[0].predicted).norm(), 1e-8);
    EXPECT_FALSE(moved_guess(Prediction{}, *before, *before, answer->values));
}

TEST_F(ExperimentTest, ColumnsAreTheSameWithAnyNumberOfThreads) {
    write("points.csv", "x_mm,y_mm,ux_mm,uy_mm\n0,-1,0,0\n3,-2,0,0\n");
    const Experiment found = experiment(sucked);
    const auto columns = [&](int jobs) {
        const ExperimentProblem problem(found, [](SimulationSettings&) {}, jobs, {});
        return problem.predict(starts_of(found.parameters()), PredictedColumns::wanted, nullptr)
            .prediction->blocks[0]
            .columns;
    };
    const Eigen::MatrixXd alone = columns(1);
    EXPECT_GT(alone.norm(), 0);
    EXPECT_LT((columns(2) - alone).norm(), 1e-9 * alone.norm());
}

/// A block pressed by a plate whose penalty follows the block; points are measured in it.
std::string pressed(const std::string& law, const std::string& top) {
    return "[mesh]\nformulation = \"plane-strain\"\nrectangle = {size_mm = [10, 4], divisions = "
           "[8, "
           "4]}\n[[material]]\n" +
           law + "\n[[fix]]\nwhere = {side = \"y-min\"}\n[[obstacle]]\nshape = \"plane\"\n" +
           "place_mm = [0, 4, 0]\ndirection = [0, -1, 0]\nmotion_mm = [0, -0.3, 0]\nwhere = " +
           top +
           "\n[newton]\nrelative_tolerance = 1e-12\n[[data]]\nkind = \"points\"\nfile = "
           "\"points.csv\"\nsd_mm = 0.1\n";
}

TEST_F(ExperimentTest, ColumnsAtTheEndOfWhatALawAllowsAreOneSided) {
    write("points.csv", "x_mm,y_mm,ux_mm,uy_mm\n3,2,0,0\n8,3,0,0\n");
    const Experiment found =
        experiment(pressed("law = \"yeoh\"\nc1_kpa = {unknown = true, start = 2}\nc2_kpa = {value "
                           "= 0, sd = 0.5}\nc3_kpa = 0\nkappa_kpa "
                           "= 20",
                           "{side = \"y-max\"}"));
    const ExperimentProblem problem(found, [](SimulationSettings&) {}, 1, {});
    const auto made =
        problem.predict(Eigen::Vector2d(2, 0), PredictedColumns::wanted, nullptr).prediction;
    ASSERT_TRUE(made);
    const auto at = [&](double c2) {
        return problem.predict(Eigen::Vector2d(2, c2), PredictedColumns::none, nullptr)
            .prediction->blocks[0]
            .predicted;
    };
    const Eigen::VectorXd slope = (-3 * at(0) + 4 * at(1e-4) - at(2e-4)) / 2e-4;
    EXPECT_GT(slope.norm(), 0);
    EXPECT_LT((made->blocks[0].columns.col(1) - slope).norm(), 1e-4 * slope.norm());
}

TEST_F(ExperimentTest, WhereALoadActsIsNoSizeOfIt) {
    write("points.csv", "x_mm,y_mm,ux_mm,uy_mm\n3,2,0,0\n8,3,0,0\n");
    const Experiment found = experiment(
        pressed("law = \"neo-hookean\"\nstiffness_kpa = \"unknown\"\npoisson_ratio = 0.3",
                "{side = \"y-max\"}\n[[pressure]]\nkpa = 1\nwhere = {centre_mm = [5, 4, 0], "
                "radius_mm = {value = 2, sd = 0.1}}"));
    const ExperimentProblem problem(found, [](SimulationSettings&) {}, 1, {});
    ASSERT_TRUE(problem.predict(starts_of(found.parameters()), PredictedColumns::wanted, nullptr)
                    .prediction);
    EXPECT_EQ(problem.num_simulation(), 3);  // whole ones are compared
}

TEST_F(ExperimentTest, AModulusIsFoundAgainAndAPlanTellsItsInterval) {
    const Experiment blank = experiment(strip("\"unknown\"", force));
    const ExperimentProblem truth(blank, [](SimulationSettings&) {}, 1, {});
    Eigen::VectorXd values(1);
    values << 17;
    const auto made = truth.predict(values, PredictedColumns::none, nullptr).prediction;
    const Eigen::VectorXd y = made->blocks[0].predicted;
    write("exact.csv",
          "time_s,force_mn\n0.5," + std::to_string(y[0]) + "\n1," + std::to_string(y[1]) + "\n");
    std::string data = force;
    data.replace(data.find("pull.csv"), 8, "exact.csv");
    const Experiment known =
        experiment(strip("{unknown = true, start = 17}", data + "discrepancy = false\n"));
    const ExperimentProblem problem(known, [](SimulationSettings&) {}, 1, {});
    const Fit best = fit(problem, {});
    const Identified found = identify(problem, best, {});

    EXPECT_EQ(best.ending, Ending::converged);
    EXPECT_NEAR(best.values[0], 17, 0.02);
    // sd ln E = (sum (y / sd)^2)^(-1/2): the force is proportional to E.
    EXPECT_NEAR(found.parameters[0].sd, 0.5 / y.norm(), 0.02 * 0.5 / y.norm());

    const PlannedProblem planned(problem);
    const Identified expected = identify(planned, fit(planned, {}), {});
    EXPECT_NEAR(expected.parameters[0].sd, found.parameters[0].sd, 0.01 * found.parameters[0].sd);
}

}  // namespace
}  // namespace palpate
