// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "solver/elements/tet4.hpp"
#include "solver/linear/make_linear_solver.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/linear_solvers.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

constexpr double exact_tolerance = 1e-10;  ///< of the strain, fp64, direct
constexpr double device_tolerance = 1e-7;  ///< after refinement to a residual of 1e-10

Mat3 random_gradient(std::mt19937& random) {
    std::uniform_real_distribution<double> value(-0.1, 0.1);
    Mat3 gradient;
    for (int i = 0; i < 9; ++i) gradient.data()[i] = value(random);
    return gradient;
}

Mat3 strain_of(const Mat3& gradient) { return 0.5 * (gradient + gradient.transpose()); }

Mat3 tet_gradient(const Mesh& mesh, Index t, const Columns& u) {
    const Tet& tet = mesh.tets[t];
    const Tet4 geometry = tet4_geometry(mesh.nodes[tet[0]], mesh.nodes[tet[1]], mesh.nodes[tet[2]],
                                        mesh.nodes[tet[3]]);
    Mat3 gradient = Mat3::Zero();
    for (int a = 0; a < 4; ++a)
        gradient += u.block<3, 1>(3 * tet[a], 0) * geometry.gradient[a].transpose();
    return gradient;
}

class PatchTest : public testing::TestWithParam<std::string> {};

TEST_P(PatchTest, HasTheSameStrainEverywhereUnderAnAffineBoundaryDisplacement) {
    if (const auto reason = fixtures::reason_to_skip(GetParam())) GTEST_SKIP() << *reason;
    std::mt19937 random(11);
    LinearSolverOptions options = fixtures::solver_on(GetParam());
    options.relative_tolerance = 1e-10;
    const double tolerance = GetParam() == "reference" ? exact_tolerance : device_tolerance;
    const int num_meshes = GetParam() == "reference" ? 50 : 5;

    for (int trial = 0; trial < num_meshes; ++trial) {
        Mesh mesh = fixtures::box_mesh({4, 5, 3}, {40, 50, 30});
        fixtures::shake_inner_nodes(mesh, 2.0, trial);
        Model model = fixtures::free_model(mesh, {{10.0, 0.4}});
        fixtures::prescribe(model, fixtures::boundary_nodes(mesh));
        const Mat3 gradient = random_gradient(random);
        Columns b = Columns::Zero(model.num_dofs(), 1), u;
        for (Index n = 0; n < mesh.num_nodes(); ++n)
            if (model.prescribed[3 * n]) b.block<3, 1>(3 * n, 0) = gradient * mesh.nodes[n];

        make_linear_solver(model, options)->solve(b, u);

        double largest = 0;
        for (Index t = 0; t < mesh.num_tets(); ++t)
            largest = std::max(
                largest,
                (strain_of(tet_gradient(mesh, t, u)) - strain_of(gradient)).cwiseAbs().maxCoeff());
        ASSERT_LE(largest, tolerance) << "mesh " << trial;
    }
}

INSTANTIATE_TEST_SUITE_P(EveryBackend, PatchTest, testing::ValuesIn(fixtures::backend_names()),
                         [](const auto& entry) { return entry.param; });

}  // namespace
}  // namespace palpate
