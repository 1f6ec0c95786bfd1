// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/finer_mesh.hpp"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "host/apps/recover/modelling/build_model.hpp"
#include "host/apps/recover/modelling/tissue_law.hpp"
#include "solver/base/error.hpp"
#include "solver/equilibrium/rest_solver.hpp"
#include "solver/model/node_rows.hpp"
#include "tests/unit/phantom/hollow_block.hpp"

namespace palpate {
namespace {

/// A stiff cube, region 2, beside a hollow driven one, region 3; `parts` elements an edge of 10 mm.
BodyMesh cubes(Index parts) {
    return body_mesh(fixtures::region_block({6 * parts, 4 * parts, 4 * parts}, Vec3(60, 40, 40),
                                            [](const Vec3& x) {
                                                const auto is_in = [&](double low, double high) {
                                                    return x.x() > low && x.x() < high &&
                                                           std::abs(x.y() - 20) < 10 &&
                                                           std::abs(x.z() - 20) < 10;
                                                };
                                                if (is_in(10, 30)) return Index(2);
                                                return is_in(30, 40) ? Index(3) : Index(1);
                                            },
                                            {3}));
}

Settings settings() {
    return parse_settings(
        "[background]\nstiffness_kpa = 10.0\n"
        "[[organ]]\nname = \"cube\"\nlabel = 1\nrole = \"tissue\"\nstiffness_kpa = \"unknown\"\n"
        "[[organ]]\nname = \"balloon\"\nlabel = 2\nrole = \"driven\"\n",
        "cubes");
}

/// The body with the balloon moved as it grows, in equilibrium.
struct Moved {
    BodyMesh body;
    RecoveryModel recovery;
    std::vector<double> kpa;
    Eigen::VectorXd displacement;

    explicit Moved(Index parts) : body(cubes(parts)), recovery(build_model(body, settings())) {
        set_stiffness(recovery.model, 2, 60);
        kpa = moduli_of(recovery.model);
        Columns walls = Columns::Zero(recovery.model.num_dofs(), 1), solution;
        for (const Index node : recovery.driven)
            walls.middleRows<3>(3 * node) = 0.1 * (body.mesh.nodes[node] - Vec3(35, 20, 20));
        LinearSolverOptions direct;
        direct.method = LinearMethod::direct;
        const auto solver = make_rest_solver(recovery.model, direct);
        EXPECT_TRUE(solver->solve(walls, solution).converged);
        displacement = solution.col(0);
    }
    Eigen::VectorXd change() const {
        LinearSolverOptions direct;
        direct.method = LinearMethod::direct;
        return FinerMesh(body, settings(), direct).change(kpa, displacement, {});
    }
};

/// Root mean square over the nodes of `coarse` that are observed, of displacements [3 num_nodes].
double distance_at_shared_nodes(const Moved& coarse, const Eigen::VectorXd& u, const Moved& fine) {
    const auto key = [](const Vec3& x) {
        return std::make_tuple(std::lround(8 * x.x()), std::lround(8 * x.y()),
                               std::lround(8 * x.z()));
    };
    std::map<std::tuple<long, long, long>, Index> node_at;
    for (Index n = 0; n < fine.body.mesh.num_nodes(); ++n)
        node_at[key(fine.body.mesh.nodes[n])] = n;
    double sum = 0;
    for (const Index node : coarse.recovery.observed) {
        const Index other = node_at.at(key(coarse.body.mesh.nodes[node]));
        sum += (u.segment<3>(3 * node) - fine.displacement.segment<3>(3 * other)).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(coarse.recovery.observed.size()));
}

TEST(FinerMesh, TellsMostOfWhatACoarseMeshIsOffBy) {
    const Moved coarse(1), fine(4);
    const double off = distance_at_shared_nodes(coarse, coarse.displacement, fine);
    const double left =
        distance_at_shared_nodes(coarse, coarse.displacement + 4.0 / 3.0 * coarse.change(), fine);
    EXPECT_GT(off, 0.01);
    EXPECT_LT(left, 0.5 * off);
}

TEST(FinerMesh, ChangesLittleOfAFineMeshAndNothingOfItsWalls) {
    const Moved coarse(1), fine(2);
    const auto size = [](const Moved& moved) {
        return at_nodes(moved.change(), moved.recovery.observed).norm() /
               std::sqrt(static_cast<double>(moved.recovery.observed.size()));
    };
    EXPECT_LT(size(fine), 0.6 * size(coarse));
    EXPECT_GT(size(fine), 0.1 * size(coarse));
    for (const auto* held : {&coarse.recovery.driven, &coarse.recovery.fixed})
        EXPECT_LT(at_nodes(coarse.change(), *held).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(FinerMesh, FollowsTheModuli) {
    const Moved body(1);
    LinearSolverOptions direct;
    direct.method = LinearMethod::direct;
    FinerMesh finer(body.body, settings(), direct);
    const Eigen::VectorXd first = finer.change(body.kpa, body.displacement, {});
    std::vector<double> twice = body.kpa;
    for (double& kpa : twice) kpa *= 2;
    EXPECT_LT((finer.change(twice, body.displacement, {}) - first).norm(), 1e-3 * first.norm());
}

TEST(FinerMesh, GivesUpWhereItsSolverDoes) {
    const Moved body(1);
    LinearSolverOptions few;
    few.backend = "reference";
    few.max_iterations = 1;
    few.max_refinements = 1;
    EXPECT_THROW(FinerMesh(body.body, settings(), few).change(body.kpa, body.displacement, {}),
                 Error);
}

}  // namespace
}  // namespace palpate
