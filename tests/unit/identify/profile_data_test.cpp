// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/apps/identify/experiment_problem.hpp"
#include "tests/unit/identify/experiment_fixture.hpp"
#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

class ProfileDataTest : public ExperimentTest {};

TEST_F(ProfileDataTest, DisplacementsAndProfilesAreThoseOfTheDeformedBody) {
    // A block between smooth plates, stretched by a tenth along x: ux = 0.1 x, and its top sinks
    // alike.
    write("u.csv", "time_s,displacement_mm\n0.5,0\n1,0\n");
    write("z.csv", "time_s,r_mm,z_mm\n0.5,1,0\n1,1,0\n1,7.7,0\n");
    const Experiment found = experiment(
        "[mesh]\nformulation = \"plane-strain\"\nrectangle = {size_mm = [10, 4], divisions = [8, "
        "4]}\n[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = \"unknown\"\npoisson_ratio = "
        "0.3\n[[fix]]\nname = \"left\"\nwhere = {side = \"x-min\"}\ncomponents = \"x\"\n"
        "[[fix]]\nname = \"base\"\nwhere = {side = \"y-min\"}\ncomponents = \"y\"\n"
        "[[move]]\nname = \"right\"\nwhere = {side = \"x-max\"}\nx_mm = 1\ncolumn = \"pull\"\n"
        "[history]\ntime_s = [0.5, 1]\npull = [0.5, 1]\n"
        "[[data]]\nkind = \"displacement\"\nfile = \"u.csv\"\nat_mm = [3.3, 1.9]\ncomponent = "
        "\"x\"\nsd_mm = 0.1\ngain = 2\n"
        "[[data]]\nkind = \"profile\"\nfile = \"z.csv\"\nwhere = {side = \"y-max\"}\nsd_mm = "
        "0.1\n");
    const ExperimentProblem problem(found, [](SimulationSettings&) {}, 1, {});
    const auto made = std::dynamic_pointer_cast<const ExperimentPrediction>(
        problem.predict(starts_of(found.parameters()), PredictedColumns::none, nullptr).prediction);

    EXPECT_NEAR(made->blocks[0].predicted[0], 2 * 0.05 * 3.3, 1e-9);
    EXPECT_NEAR(made->blocks[0].predicted[1], 2 * 0.10 * 3.3, 1e-9);
    const SolidMesh& mesh = made->simulation->mesh();
    Index corner = 0;  // of the top and the right
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (mesh.nodes[n].x() > 10 - 1e-9 && mesh.nodes[n].y() > 4 - 1e-9) corner = n;
    const auto height = [&](std::size_t state) {
        return 4 + made->simulation->states[state].displacement[3 * corner + 1];
    };
    EXPECT_LT(height(2), 4 - 0.05);
    EXPECT_NEAR(made->blocks[1].predicted[0], height(1), 1e-9);
    EXPECT_NEAR(made->blocks[1].predicted[1], height(2), 1e-9);
    EXPECT_NEAR(made->blocks[1].predicted[2], height(2), 1e-9);
}

TEST_F(ProfileDataTest, AGuessedSurfaceIsHigherByItsErrorAndATurnedCameraAddsATilt) {
    // A block that does not move, 4 mm high.
    write("z.csv", "time_s,r_mm,z_mm\n1,1,0\n1,3,0\n1,4,0\n1,8,0\n");
    const auto heights = [&](const std::string& more) {
        const Experiment found = experiment(
            "[mesh]\nformulation = \"plane-strain\"\nrectangle = {size_mm = [10, 4], divisions "
            "= [10, 4]}\n[[material]]\nlaw = \"neo-hookean\"\nstiffness_kpa = \"unknown\"\n"
            "poisson_ratio = 0.3\n[[fix]]\nname = \"base\"\nwhere = {side = \"y-min\"}\n"
            "[history]\ntime_s = [1]\n[[data]]\nkind = \"profile\"\nfile = \"z.csv\"\n"
            "where = {side = \"y-max\"}\nsd_mm = 0.1\n" +
            more);
        const ExperimentProblem problem(found, [](SimulationSettings&) {}, 1, {});
        return problem.predict(starts_of(found.parameters()), PredictedColumns::none, nullptr)
            .prediction->blocks[0]
            .predicted;
    };
    const Eigen::VectorXd risen = heights(
        "rest_error = [{r_mm = 2, z_mm = 0}, {r_mm = 4, z_mm = -0.2}, {r_mm = 6, z_mm = 0}]\n");
    EXPECT_NEAR(risen[0], 4, 1e-9);
    EXPECT_NEAR(risen[1], 3.9, 1e-9);
    EXPECT_NEAR(risen[2], 3.8, 1e-9);
    EXPECT_NEAR(risen[3], 4, 1e-9);
    const Eigen::VectorXd tilted = heights("tilt = 0.01\n");
    EXPECT_NEAR(tilted[3], 4.08, 1e-9);
    EXPECT_THROW(heights("rest_error = [{r_mm = 2, z_mm = 0}, {r_mm = 1, z_mm = 0}]\n"), Error);
    EXPECT_THROW(heights("rest_error = [{r_mm = 2}]\n"), Error);
}

/// A small section under a tube that sucks, and its profile.
///   edge   "edge_mm = ...", or "edge_of = ..."
std::string suction(const std::string& edge) {
    return "[mesh]\nformulation = \"axisymmetric\"\nvolume = \"element-mean\"\n"
           "graded = {width_mm = 20, depth_mm = {value = 16, sd = 2}, " +
           edge +
           ", columns_inside = 8, columns_outside = 5, rows = 6, finest_mm = 0.5, "
           "surface_x_mm = [0, 2.5, 5.2], surface_y_mm = [0.8, 0.4, 0]}\n"
           "[[material]]\nlaw = \"veronda-westmann\"\nmu_kpa = \"unknown\"\ngamma = 8\n"
           "kappa_kpa = 500\nrelaxation = [{amplitude = 0.4, time_s = 4}]\n"
           "[[fix]]\nwhere = {side = \"y-min\"}\n"
           "[[obstacle]]\nname = \"tube\"\nshape = \"tube\"\nplace_mm = [0, 0]\n"
           "direction = [0, -1]\nhole_radius_mm = {value = 5, sd = 0.03}\nedge_radius_mm = {value "
           "= 0.2, sd = 0.05}\n"
           "outer_radius_mm = 10\nfriction = {unknown = true, start = 0.2}\n"
           "stiffness_kpa_per_mm = 500\nwhere = {point_array = \"surface\"}\n"
           "[[pressure]]\nkpa = -1\nfollows = true\ncolumn = \"suck\"\n"
           "where = {point_array = \"surface\", to_mm = [5.201, 9]}\n"
           "[history]\ntime_s = [1, 2, 3, 4]\nsuck = [1.5, 3, 3, 1]\n"
           "[newton]\nrelative_tolerance = 1e-12\n"
           "[[data]]\nkind = \"profile\"\nfile = \"z.csv\"\nsd_mm = 0.02\n"
           "where = {point_array = \"surface\"}\ndelay_s = {value = 0, sd = 0.02}\n"
           "r_scale = {value = 1, sd = 0.005}\nz_scale = {value = 1, sd = 0.005}\n"
           "tilt = {value = 0, sd = 0.01}\nr_offset_mm = {value = 0, sd = 0.1}\nrest_error = "
           "[{r_mm = 1, z_mm = 0}, "
           "{r_mm = 3, z_mm = {value = 0, sd = 0.2}}, {r_mm = 5.2, z_mm = 0}]\n";
}

/// The prediction at the start, whose columns are held to whole simulations.
std::shared_ptr<const Prediction> checked_columns(const Experiment& found,
                                                  const ExperimentProblem& problem) {
    const Eigen::VectorXd values = starts_of(found.parameters());
    const auto centre = problem.predict(values, PredictedColumns::wanted, nullptr).prediction;
    for (Eigen::Index k = 0; k < values.size(); ++k) {
        const double h = 1e-5 * std::max(0.2, std::abs(values[k]));
        const auto at = [&](double sign) {
            Eigen::VectorXd moved = values;
            moved[k] += sign * h;
            return problem.predict(moved, PredictedColumns::none, centre.get())
                .prediction->blocks[0]
                .predicted;
        };
        const Eigen::VectorXd slope = (at(1) - at(-1)) / (2 * h);
        EXPECT_GT(slope.norm(), 0) << found.paths()[k];
        EXPECT_LT((centre->blocks[0].columns.col(k) - slope).norm(), 1e-4 * slope.norm())
            << found.paths()[k];
    }
    return centre;
}

/// The mesh's edge is that of the tube: its hole and its rounding move nodes.
TEST_F(ProfileDataTest, ColumnsOfAnEdgeThatTheMeshFollowsComeWithOneSimulation) {
    write("z.csv", "time_s,r_mm,z_mm\n1.3,0,1\n2.4,2,1\n3.5,4,1\n");
    const Experiment found = experiment(suction("edge_of = \"tube\""));
    const ExperimentProblem problem(found, [](SimulationSettings&) {}, 1, {});
    problem.predict(starts_of(found.parameters()), PredictedColumns::wanted, nullptr);
    EXPECT_EQ(problem.num_simulation(), 1);

    checked_columns(found, problem);
}

TEST_F(ProfileDataTest, ColumnsOfAnInstrumentAreThoseOfWholeSimulations) {
    write("z.csv", "time_s,r_mm,z_mm\n1.3,0,1\n2.4,2,1\n3.5,4,1\n");
    const Experiment found = experiment(suction("edge_mm = 5.2"));
    const ExperimentProblem problem(found, [](SimulationSettings&) {}, 2, {});
    ASSERT_EQ(found.parameters().size(), 11u);

    const auto centre = checked_columns(found, problem);
    // From the heights that the file has: z_scale z.
    const DataBlock& block = centre->blocks[0];
    const auto scale = std::find(found.paths().begin(), found.paths().end(), "data[1].z_scale");
    ASSERT_NE(scale, found.paths().end());
    EXPECT_LT((block.columns.col(scale - found.paths().begin()) - block.predicted).norm(),
              1e-6 * block.predicted.norm());
}

/// A row at r is of the model's place |r - r_offset_mm|.
TEST_F(ProfileDataTest, AnAxisBesideThatOfTheTableMovesTheProfile) {
    const auto heights = [&](const std::string& places, const std::string& offset) {
        write("z.csv", "time_s,r_mm,z_mm\n" + places);
        std::string text = suction("edge_mm = 5.2");
        const std::string open = "r_offset_mm = {value = 0, sd = 0.1}";
        text.replace(text.find(open), open.size(), "r_offset_mm = " + offset);
        const Experiment found = experiment(text);
        const ExperimentProblem problem(found, [](SimulationSettings&) {}, 1, {});
        return problem.predict(starts_of(found.parameters()), PredictedColumns::none, nullptr)
            .prediction->blocks[0]
            .predicted;
    };
    const Eigen::VectorXd beside = heights("2.4,2.5,1\n2.4,-1.5,1\n2.4,0.5,1\n", "0.5"),
                          centred = heights("2.4,2,1\n2.4,-2,1\n2.4,0,1\n", "0");
    EXPECT_LT((beside - centred).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_GT(centred[2] - centred[0], 0.1);
}

/// What was guessed wrong at a place at rest goes with the tissue there, whatever nodes are near.
TEST_F(ProfileDataTest, AnErrorOfTheRestIsThatOfTheTissueAndNotOfTheNodes) {
    write("z.csv", "time_s,r_mm,z_mm\n2.4,2.6,1\n2.4,3.05,1\n2.4,3.3,1\n2.4,4,1\n");
    const auto column = [&](const std::string& mesh) {
        const Experiment found = experiment(suction("edge_mm = 5.2, " + mesh));
        const ExperimentProblem problem(found, [](SimulationSettings&) {}, 2, {});
        const auto made =
            problem.predict(starts_of(found.parameters()), PredictedColumns::wanted, nullptr);
        const auto error =
            std::find(found.paths().begin(), found.paths().end(), "data[1].rest_error[2].z_mm");
        EXPECT_NE(error, found.paths().end());
        return Eigen::VectorXd(
            made.prediction->blocks[0].columns.col(error - found.paths().begin()));
    };
    const Eigen::VectorXd coarse = column("refine = 1"), fine = column("refine = 3");
    EXPECT_LT((coarse - fine).cwiseAbs().maxCoeff(), 0.01);
    EXPECT_GT(coarse.minCoeff(), 0.5);
    EXPECT_LT(coarse.maxCoeff(), 1 + 1e-9);
}

TEST_F(ProfileDataTest, ASimulationThatBeginsFromAnotherOneSaysTheSame) {
    write("z.csv", "time_s,r_mm,z_mm\n1.3,0,1\n2.4,2,1\n3.5,4,1\n");
    const Experiment found = experiment(suction("edge_mm = 5.2"));
    const ExperimentProblem problem(found, [](SimulationSettings&) {}, 2, {});
    const Eigen::VectorXd values = starts_of(found.parameters());
    const auto centre = problem.predict(values, PredictedColumns::wanted, nullptr).prediction;
    for (const double factor : {0.5, 0.9, 1.2, 2.0}) {
        Eigen::VectorXd moved = values;
        moved[1] *= factor;
        ASSERT_EQ(found.paths()[1], "material[1].mu_kpa");
        const auto warm = problem.predict(moved, PredictedColumns::none, centre.get());
        const auto cold = problem.predict(moved, PredictedColumns::none, nullptr);
        ASSERT_TRUE(warm.prediction && cold.prediction) << warm.failure << cold.failure;
        EXPECT_LT((warm.prediction->blocks[0].predicted - cold.prediction->blocks[0].predicted)
                      .cwiseAbs()
                      .maxCoeff(),
                  1e-8)
            << factor;
    }
}

}  // namespace
}  // namespace palpate
