// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "solver/linear/make_linear_solver.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/linear_solvers.hpp"
#include "tests/fixtures/meshes.hpp"

// Thick-walled sphere under internal pressure p: Lame's solution (Timoshenko and Goodier, Theory of
// Elasticity, 1970, section 136): u(r) = A r + B / r^2 with
//   B = p a^3 b^3 / (4 mu (b^3 - a^3)),   A = 4 mu B / ((3 lambda + 2 mu) b^3)
namespace palpate {
namespace {

constexpr double inner_radius = 30, outer_radius = 50;  // mm
constexpr double pressure = 2;                          // kPa
const LinearElastic material{10.0, 0.35};

double exact_displacement(double r) {
    const double lambda = material.stiffness_kpa * material.unit_lambda();
    const double mu = material.stiffness_kpa * material.unit_mu();
    const double a3 = std::pow(inner_radius, 3), b3 = std::pow(outer_radius, 3);
    const double b = pressure * a3 * b3 / (4 * mu * (b3 - a3));
    return 4 * mu * b / ((3 * lambda + 2 * mu) * b3) * r + b / (r * r);
}

/// One octant; each symmetry plane holds the component across it.
Model octant_model(Index subdivisions, Index layers) {
    Model model = fixtures::free_model(
        fixtures::octant_shell_mesh(subdivisions, layers, inner_radius, outer_radius), {material});
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        for (Index c = 0; c < 3; ++c)
            if (model.mesh.nodes[n][c] == 0) model.prescribed[3 * n + c] = 1;
    return model;
}

/// Pressure on the faces whose three nodes lie on the inner sphere, a third of each to each node.
Columns pressure_forces(const Model& model) {
    Columns b = Columns::Zero(model.num_dofs(), 1);
    const Mesh& mesh = model.mesh;
    const auto is_inner = [&](Index n) {
        return std::abs(mesh.nodes[n].norm() - inner_radius) < 1e-9;
    };
    for (const Tet& tet : mesh.tets)
        for (int skip = 0; skip < 4; ++skip) {
            const Triangle face{tet[(skip + 1) % 4], tet[(skip + 2) % 4], tet[(skip + 3) % 4]};
            if (!is_inner(face[0]) || !is_inner(face[1]) || !is_inner(face[2])) continue;
            Vec3 area = 0.5 * (mesh.nodes[face[1]] - mesh.nodes[face[0]])
                                  .cross(mesh.nodes[face[2]] - mesh.nodes[face[0]]);
            if (area.dot(mesh.nodes[face[0]]) < 0) area = -area;
            for (Index n : face) b.block<3, 1>(3 * n, 0) += pressure / 3 * area;
        }
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) b(d, 0) = 0;
    return b;
}

/// Relative error of the displacement over all nodes.
double error_of(Index subdivisions, Index layers, const LinearSolverOptions& options) {
    const Model model = octant_model(subdivisions, layers);
    Columns u;
    EXPECT_TRUE(make_linear_solver(model, options)->solve(pressure_forces(model), u).converged);
    double error = 0, scale = 0;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const double r = model.mesh.nodes[n].norm();
        const Vec3 exact = exact_displacement(r) * model.mesh.nodes[n] / r;
        error += (u.block<3, 1>(3 * n, 0) - exact).squaredNorm();
        scale += exact.squaredNorm();
    }
    return std::sqrt(error / scale);
}

class ThickSphere : public testing::TestWithParam<std::string> {};

TEST_P(ThickSphere, ConvergesToLamesSolution) {
    if (const auto reason = fixtures::reason_to_skip(GetParam())) GTEST_SKIP() << *reason;
    LinearSolverOptions options = fixtures::solver_on(GetParam());

    const double coarse = error_of(6, 4, options);
    const double medium = error_of(12, 8, options);
    const double fine = error_of(24, 16, options);

    EXPECT_LT(fine, 0.01);
    EXPECT_GT(std::log2(coarse / medium), 1.5);
    EXPECT_GT(std::log2(medium / fine), 1.7);
    RecordProperty("fine_error", std::to_string(fine));
}

INSTANTIATE_TEST_SUITE_P(EveryBackend, ThickSphere, testing::ValuesIn(fixtures::backend_names()),
                         [](const auto& entry) { return entry.param; });

}  // namespace
}  // namespace palpate
