// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "solver/equilibrium/time_steps.hpp"
#include "solver/equilibrium/viscous_history.hpp"
#include "solver/materials/registry.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

// What relaxes only in its changes of shape: closed forms of bars, and stability under suction.
namespace palpate {
namespace {

const std::vector<RelaxationTerm> terms{{0.8, 0.5}, {0.4, 6.0}};

/// G(t) = 1 + sum C_k exp(-t / tau_k)
double relaxation_at(double time_s, const std::vector<RelaxationTerm>& of) {
    double sum = 1;
    for (const RelaxationTerm& term : of) sum += term.amplitude * std::exp(-time_s / term.time_s);
    return sum;
}

/// A cube of 2 mm that may slide on three of its sides, its top moved.
struct Bar {
    SolidModel model;
    SolidLoads stretched;
    double force_of(const Equilibrium& state) const {
        double sum = 0;
        for (Index n = 0; n < model.mesh.num_nodes(); ++n)
            if (model.mesh.nodes[n].z() > 2 - 1e-9) sum += state.reaction[3 * n + 2];
        return sum;
    }
};

Bar make_bar(const SolidMaterial& material, double rise_mm) {
    SolidModel model = fixtures::solid_model(
        with_edge_nodes(solid_mesh_of(fixtures::box_mesh({1, 1, 1}, Vec3(2, 2, 2)))), material);
    model.volume = VolumeTreatment::element_mean;
    Bar bar{model,
            {Eigen::VectorXd::Zero(model.num_dofs()), Eigen::VectorXd::Zero(model.num_dofs())}};
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        for (int i = 0; i < 3; ++i)
            if (x[i] < 1e-9) bar.model.prescribed[3 * n + i] = 1;
        if (x.z() < 2 - 1e-9) continue;
        bar.model.prescribed[3 * n + 2] = 1;
        bar.stretched.displacement[3 * n + 2] = rise_mm;
    }
    return bar;
}

struct NearlyIncompressible {
    SolidMaterial material;
    double first, second;  ///< psi' at x is first + second x, or first e^(second x)
    bool is_exponential = false;
    double slope_at(double x) const {
        return is_exponential ? first * std::exp(second * x) : first + second * x;
    }
};

// Where the volume stays, S of the changes of shape stays with the stretch, and the pressure is
// such that nothing acts sideways: P = 2 psi'(x) (l - l^-2) G(t), x = l^2 + 2/l - 3.
TEST(IsochoricRelaxation, AStretchedBarFollowsTheRelaxationFunction) {
    constexpr double stretch = 1.25, x = stretch * stretch + 2 / stretch - 3;
    constexpr double tolerance = 3e-4;  // the bulk modulus is 1e4 times the shear modulus
    const double neo_shear = 10 / (2 * 1.49995);
    const std::vector<NearlyIncompressible> laws{
        {{"neo-hookean", {10, 0.49995}, terms}, neo_shear / 2, 0},
        {{"neo-hookean-reduced", {2, 4e4}, terms}, 2, 0},
        {{"veronda-westmann", {1.5, 3, 3e4}, terms}, 1.5, 3, true},
        {{"reduced-polynomial", {1.5, 2, 2 / 3e4}, terms}, 1.5, 4}};
    for (NearlyIncompressible law : laws)
        for (const bool is_instantaneous : {false, true}) {
            law.material.relaxation_of = RelaxationOf::isochoric;
            law.material.is_instantaneous = is_instantaneous;
            const Bar bar = make_bar(law.material, 2 * (stretch - 1));
            std::vector<LoadTime> times;
            for (const double t : {1e-6, 0.2, 0.7, 2.0, 9.0}) times.push_back({t, bar.stretched});

            const auto states = solve_history(bar.model, times, {});

            ASSERT_EQ(states.size(), times.size()) << law.material.law;
            const double height = is_instantaneous ? relaxation_at(0, terms) : 1;
            const double lasting =
                4 * 2 * law.slope_at(x) * (stretch - 1 / (stretch * stretch)) / height;
            for (std::size_t k = 0; k < times.size(); ++k)
                EXPECT_NEAR(bar.force_of(states[k]) / lasting,
                            relaxation_at(times[k].time_s, terms), 2.2 * tolerance)
                    << law.material.law << " after " << times[k].time_s << " s";
        }
}

// Hooke's law with a shear modulus G (1 + C exp(-t / tau)) and a bulk modulus K that stays: by
// Laplace's transform the force of a held strain is that of Young's modulus
//   E + (E0 - E) exp(-t / tau'),   E = 9 K G / (3 K + G),   E0 the same with (1 + C) G,
//   tau' = tau (3 K + (1 + C) G) / (3 K + G).
TEST(IsochoricRelaxation, ACompressibleBarOfHookesLawHasALongerTime) {
    constexpr double poisson = 0.3, young = 10, amplitude = 0.8, time_s = 2;
    const double shear = young / (2 * (1 + poisson)), bulk = young / (3 * (1 - 2 * poisson));
    const auto young_of = [&](double g) { return 9 * bulk * g / (3 * bulk + g); };
    const double sudden = young_of((1 + amplitude) * shear);
    const double longer = time_s * (3 * bulk + (1 + amplitude) * shear) / (3 * bulk + shear);
    SolidMaterial material{"linear", {young, poisson}, {{amplitude, time_s}}};
    material.relaxation_of = RelaxationOf::isochoric;
    const Bar bar = make_bar(material, 0.1);
    std::vector<LoadTime> times{{1e-6, bar.stretched}};
    for (int k = 1; k <= 50; ++k) times.push_back({0.1 * k, bar.stretched});

    const auto states = solve_history(bar.model, times, {});

    ASSERT_EQ(states.size(), times.size());
    for (std::size_t k = 0; k < times.size(); k += 10) {
        const double decay = std::exp(-times[k].time_s / longer);
        // Area 4, strain 0.05; second order in the steps.
        EXPECT_NEAR(bar.force_of(states[k]), 4 * 0.05 * (young + (sudden - young) * decay), 2e-4)
            << times[k].time_s;
    }
}

/// The least eigenvalue of the free dofs of K, mN/mm.
double least_eigenvalue(const SolidAssembly& solid, const Eigen::VectorXd& u) {
    BlockMatrix matrix = solid.make_matrix();
    solid.tangent(u, matrix);
    std::vector<Index> number(solid.model().prescribed.size());
    Index count = 0;
    for (std::size_t d = 0; d < number.size(); ++d)
        number[d] = solid.model().prescribed[d] ? -1 : count++;
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(count, count);
    for (Index a = 0; a < matrix.num_rows(); ++a)
        for (Index k = matrix.graph.offsets[a]; k < matrix.graph.offsets[a + 1]; ++k)
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) {
                    const Index row = number[3 * a + i],
                                column = number[3 * matrix.graph.items[k] + j];
                    if (row >= 0 && column >= 0) dense(row, column) = matrix.block(k)[3 * i + j];
                }
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense, Eigen::EigenvaluesOnly)
        .eigenvalues()[0];
}

/// Soft tissue under the hole of a tube, sucked within a second and held.
struct Suction {
    SolidModel model;
    std::vector<LoadTime> times;
};

Suction make_suction(RelaxationOf which) {
    SolidMaterial material{"veronda-westmann", {0.7, 12, 1000}, {{0.41, 4.7}}};
    material.relaxation_of = which;
    SolidModel model = fixtures::solid_model(
        fixtures::rectangle_mesh(ElementType::quad4, Formulation::axisymmetric, {10, 6},
                                 {15.0, 10.0}),
        material);
    model.volume = VolumeTreatment::element_mean;
    const SolidMesh& mesh = model.mesh;
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        const bool is_under_the_rim = mesh.nodes[n].y() > 10 - 1e-9 && mesh.nodes[n].x() > 5.9;
        if (mesh.nodes[n].y() < 1e-9 || is_under_the_rim) model.prescribed[3 * n + 1] = 1;
        if (mesh.nodes[n].y() < 1e-9 || mesh.nodes[n].x() > 15 - 1e-9) model.prescribed[3 * n] = 1;
    }
    const auto hole = boundary_faces(
        mesh, [&](Index n) { return mesh.nodes[n].y() > 10 - 1e-9 && mesh.nodes[n].x() < 6.1; });
    const Eigen::VectorXd force = traction_forces(
        mesh, hole, [](const Vec3&, const Vec3& normal) -> Vec3 { return 10 * normal; });
    Suction suction{model, {}};
    for (double t = 0.25; t < 16.1; t += t < 0.99 ? 0.25 : 1.0)
        suction.times.push_back(
            {t, {Eigen::VectorXd::Zero(model.num_dofs()), std::min(1.0, t) * force}});
    return suction;
}

/// The least eigenvalues at all times that are reached, over that at rest.
std::vector<double> eigenvalues_under_suction(RelaxationOf which) {
    const Suction suction = make_suction(which);
    std::vector<double> found;
    const double at_rest = least_eigenvalue(SolidAssembly(suction.model),
                                            Eigen::VectorXd::Zero(suction.model.num_dofs()));
    solve_history(suction.model, suction.times, {}, {},
                  [&](const SolidAssembly& solid, const Equilibrium& state) {
                      if (state.converged)
                          found.push_back(least_eigenvalue(solid, state.displacement) / at_rest);
                  });
    return found;
}

// The frozen pressure of earlier steps, C p, works like a negative shear stiffness as soon as it
// outweighs 2 psi'.
TEST(IsochoricRelaxation, KeepsTissueStableUnderHeldSuctionWhereTotalRelaxationDoesNot) {
    const std::vector<double> isochoric = eigenvalues_under_suction(RelaxationOf::isochoric);
    const std::vector<double> total = eigenvalues_under_suction(RelaxationOf::total);

    EXPECT_EQ(isochoric.size(), make_suction(RelaxationOf::isochoric).times.size());
    EXPECT_GT(*std::min_element(isochoric.begin(), isochoric.end()), 1);
    EXPECT_GT(isochoric.back(), 3);
    EXPECT_GT(*std::max_element(total.begin(), total.end()), 2);
    EXPECT_LT(*std::min_element(total.begin(), total.end()), 0.7);
}

}  // namespace
}  // namespace palpate
