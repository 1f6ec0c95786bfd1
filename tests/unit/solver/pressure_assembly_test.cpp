// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/pressure_assembly.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "solver/adjoint/history_adjoint.hpp"
#include "solver/adjoint/sensitivity_columns.hpp"
#include "solver/adjoint/solid_adjoint.hpp"
#include "solver/base/error.hpp"
#include "solver/equilibrium/explicit_steps.hpp"
#include "solver/model/block_product.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

using fixtures::LoadedModel;

const SolidMaterial soft{"neo-hookean", {10, 0.35}};

/// Every element's faces or edges, also quadratic edges about an axis.
std::vector<SolidMesh> pressed_meshes() {
    std::vector<SolidMesh> meshes = fixtures::solid_meshes();
    SolidMesh turned =
        fixtures::rectangle_mesh(ElementType::tri3, Formulation::axisymmetric, {3, 2}, {3.0, 2.0});
    meshes.push_back(with_edge_nodes(turned));
    meshes[3].thickness_mm = 0.7;
    return meshes;
}

std::string name_of(const SolidMesh& mesh) {
    return std::string(mesh.table().name) + " " + palpate::name_of(mesh.formulation);
}

int up_in(const SolidMesh& mesh) { return mesh.formulation == Formulation::solid ? 2 : 1; }

PressureSurface top_of(const SolidMesh& mesh) {
    return {boundary_faces(mesh, [&](Index n) { return mesh.nodes[n][up_in(mesh)] > 2 - 1e-9; })};
}

Eigen::VectorXd waves(const SolidMesh& mesh, double size, double rate) {
    Eigen::VectorXd u(3 * mesh.num_nodes());
    for (Index d = 0; d < u.size(); ++d) u[d] = size * std::sin(rate * d + 0.3);
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        if (mesh.formulation == Formulation::solid) continue;
        u[3 * n + 2] = 0;
        if (mesh.formulation == Formulation::axisymmetric && mesh.nodes[n].x() == 0) u[3 * n] = 0;
    }
    return u;
}

SolidModel with_pressure(const SolidMesh& mesh, const PressureSurface& surface) {
    SolidModel model = fixtures::solid_model(mesh, soft);
    model.pressures = {surface};
    return model;
}

Eigen::VectorXd force_of(const PressureAssembly& pressure, const Eigen::VectorXd& u) {
    InternalForce sum;
    sum.force.setZero(u.size());
    pressure.add_force(u, sum);
    return -sum.force;
}

template <class Work>
void for_each_mesh(const Work& work) {
    for (const SolidMesh& mesh : pressed_meshes()) work(mesh, name_of(mesh));
}

TEST(FollowingPressure, AtRestItIsThePressureOnTheUndeformedSurface) {
    for_each_mesh([](const SolidMesh& mesh, const std::string& name) {
        const SolidModel model = with_pressure(mesh, top_of(mesh));
        PressureAssembly pressure(model);
        pressure.set({3});
        const Eigen::VectorXd expected =
            traction_forces(mesh, model.pressures[0].faces,
                            [](const Vec3&, const Vec3& normal) -> Vec3 { return -3 * normal; });
        const Eigen::VectorXd found = force_of(pressure, Eigen::VectorXd::Zero(expected.size()));
        EXPECT_LT((found - expected).norm(), 1e-13 * expected.norm()) << name;
    });
}

TEST(FollowingPressure, ForceIsTheSlopeOfTheWork) {
    for_each_mesh([](const SolidMesh& mesh, const std::string& name) {
        const SolidModel model = with_pressure(mesh, top_of(mesh));
        PressureAssembly pressure(model);
        pressure.set({3});
        const Eigen::VectorXd u = waves(mesh, 0.2, 1.3), v = waves(mesh, 1, 0.7);
        constexpr double step = 1e-5;
        const double slope =
            (pressure.work(u, u + step * v) - pressure.work(u, u - step * v)) / (2 * step);
        EXPECT_NEAR(slope, force_of(pressure, u).dot(v), 1e-8 * std::abs(slope)) << name;
        // Along a line it is a potential.
        const double whole = pressure.work(u, u + v), half = pressure.work(u, u + 0.4 * v);
        EXPECT_NEAR(whole, half + pressure.work(u + 0.4 * v, u + v), 1e-12 * std::abs(whole))
            << name;
    });
}

TEST(FollowingPressure, StiffnessIsTheSlopeOfTheForce) {
    for_each_mesh([](const SolidMesh& mesh, const std::string& name) {
        const SolidModel model = with_pressure(mesh, top_of(mesh));
        PressureAssembly pressure(model);
        pressure.set({3});
        const SolidAssembly solid(model);
        BlockMatrix symmetric = solid.make_matrix(), antisymmetric = symmetric, turned = symmetric;
        const Eigen::VectorXd u = waves(mesh, 0.2, 1.3), v = waves(mesh, 1, 0.7),
                              w = waves(mesh, 1, 1.1);
        pressure.add_symmetric(u, symmetric);
        pressure.add_antisymmetric(u, false, antisymmetric);
        pressure.add_antisymmetric(u, true, turned);
        constexpr double step = 1e-5;
        const Eigen::VectorXd expected =
            (force_of(pressure, u - step * v) - force_of(pressure, u + step * v)) / (2 * step);
        const Eigen::VectorXd found = times(symmetric, v).col(0) + times(antisymmetric, v).col(0);
        EXPECT_LT((found - expected).norm(), 1e-8 * expected.norm()) << name;
        const double scale = expected.norm() * w.norm();
        EXPECT_NEAR(w.dot(times(symmetric, v).col(0)), v.dot(times(symmetric, w).col(0)),
                    1e-13 * scale)
            << name;
        EXPECT_NEAR(v.dot(times(antisymmetric, v).col(0)), 0, 1e-13 * scale) << name;
        EXPECT_NEAR(w.dot(times(turned, v).col(0)), v.dot(times(antisymmetric, w).col(0)),
                    1e-13 * scale)
            << name;
        EXPECT_GT(times(antisymmetric, v).norm(), 1e-3 * expected.norm()) << name;
    });
}

// 3 V of what a surface bounds is the integral of x . n, 2 A in a plane.
double volume_of(const SolidMesh& mesh, const PressureSurface& surface, const Eigen::VectorXd& u) {
    double sum = 0;
    for (const Face& face : surface.faces)
        for (const ParametricPoint& point : parametric_points(mesh.formulation, face.size())) {
            std::array<Vec3, 6> place;
            Vec3 at = Vec3::Zero();
            for (std::size_t a = 0; a < face.size(); ++a) {
                place[a] = mesh.nodes[face[a]] + u.segment<3>(3 * face[a]);
                at += point.value[a] * place[a];
            }
            const Vec3 area = DeformedArea(mesh, point, place, face.size()).vector();
            const double parts = mesh.formulation == Formulation::plane_strain ||
                                         mesh.formulation == Formulation::plane_stress
                                     ? 2
                                     : 3;
            sum += point.weight * at.dot(area) / parts;
        }
    return sum;
}

// A closed surface: no resultant, no moment, symmetric, and the work is -P times the new volume.
TEST(FollowingPressure, RoundAClosedSurfaceItBalancesAndHasAPotential) {
    for_each_mesh([](const SolidMesh& mesh, const std::string& name) {
        const SolidModel model = with_pressure(mesh, {boundary_faces(mesh)});
        PressureAssembly pressure(model);
        pressure.set({3});
        const Eigen::VectorXd u = waves(mesh, 0.2, 1.3), v = waves(mesh, 1, 0.7);
        const Eigen::VectorXd force = force_of(pressure, u);
        Vec3 resultant = Vec3::Zero(), moment = Vec3::Zero();
        for (Index n = 0; n < mesh.num_nodes(); ++n) {
            const Vec3 at = mesh.nodes[n] + u.segment<3>(3 * n);
            resultant += force.segment<3>(3 * n);
            moment += at.cross(force.segment<3>(3 * n));
        }
        const bool is_turned = mesh.formulation == Formulation::axisymmetric;
        if (is_turned) resultant.x() = 0;  // radial forces cancel round the axis
        EXPECT_LT(resultant.norm(), 1e-13 * force.norm()) << name;
        if (!is_turned) {
            EXPECT_LT(moment.norm(), 1e-12 * force.norm()) << name;
        }
        const double bulge =
            volume_of(mesh, model.pressures[0], u + v) - volume_of(mesh, model.pressures[0], u);
        EXPECT_NEAR(pressure.work(u, u + v), -3 * bulge, 1e-12 * std::abs(bulge)) << name;
        BlockMatrix symmetric = SolidAssembly(model).make_matrix(), antisymmetric = symmetric;
        pressure.add_symmetric(u, symmetric);
        pressure.add_antisymmetric(u, false, antisymmetric);
        EXPECT_LT(times(antisymmetric, v).norm(), 1e-13 * times(symmetric, v).norm()) << name;
    });
}

// About the axis the potential is -P 2 pi int r z dr but for 2 pi r z dr at the end of the curve.
TEST(FollowingPressure, AboutTheAxisOnlyTheEndOfACurveIsNotSymmetric) {
    const SolidMesh mesh = pressed_meshes().back();
    const SolidModel model = with_pressure(mesh, top_of(mesh));
    PressureAssembly pressure(model);
    pressure.set({3});
    const Eigen::VectorXd u = waves(mesh, 0.2, 1.3);
    BlockMatrix antisymmetric = SolidAssembly(model).make_matrix();
    pressure.add_antisymmetric(u, false, antisymmetric);
    Index end = 0;
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (mesh.nodes[n].x() > 3 - 1e-9 && mesh.nodes[n].y() > 2 - 1e-9) end = n;
    const Eigen::VectorXd v = waves(mesh, 1, 0.7), w = waves(mesh, 1, 1.1);
    const double r = mesh.nodes[end].x() + u[3 * end];
    // w . (K - K^T) v / 2 = +-pi P r (dr_w dz_v - dz_w dr_v) there
    const double end_term =
        std::numbers::pi * 3 * r * (w[3 * end] * v[3 * end + 1] - w[3 * end + 1] * v[3 * end]);
    EXPECT_NEAR(std::abs(w.dot(times(antisymmetric, v).col(0))), std::abs(end_term),
                1e-11 * std::abs(end_term));
}

/// Held at x = 0, pressed on top so that it bends down, with a free edge.
LoadedModel bent(const SolidMesh& mesh, double kpa) {
    LoadedModel work{with_pressure(mesh, top_of(mesh)), {}};
    for (Index n = 0; n < mesh.num_nodes(); ++n)
        if (mesh.nodes[n].x() < 1e-9) std::fill_n(&work.model.prescribed[3 * n], 3, 1);
    if (mesh.formulation == Formulation::axisymmetric)
        for (Index n = 0; n < mesh.num_nodes(); ++n)
            if (mesh.nodes[n].y() < 1e-9 && mesh.nodes[n].x() > 3 - 1e-9)
                work.model.prescribed[3 * n + 1] = 1;
    work.loads.displacement.setZero(work.model.num_dofs());
    work.loads.force.setZero(work.model.num_dofs());
    work.loads.pressure_kpa = {kpa};
    return work;
}

EquilibriumOptions tight() {
    EquilibriumOptions options;
    options.relative_tolerance = 1e-12;
    return options;
}

// |du_(n+1)| <= c |du_n|^2: the whole tangent, antisymmetric part included, is solved with.
TEST(FollowingPressure, NewtonsMethodSquaresTheError) {
    for_each_mesh([](const SolidMesh& mesh, const std::string& name) {
        const LoadedModel work = bent(mesh, 1.0);
        const SolidAssembly solid(work.model);
        const Equilibrium found = solve_equilibrium(solid, work.loads, tight());
        ASSERT_TRUE(found.converged) << name << ": " << found.message;
        TangentSolve& tangent = *found.tangent;
        // From near the equilibrium, so that no line search is needed.
        Eigen::VectorXd u = found.displacement, away = waves(mesh, 0.01, 0.9);
        for (Index d = 0; d < u.size(); ++d)
            if (!work.model.prescribed[d]) u[d] += away[d];
        std::vector<double> sizes;
        while (sizes.size() < 10 && (sizes.empty() || sizes.back() > 1e-6)) {
            InternalForce inner = solid.internal_force(u);
            tangent.pressure().add_force(u, inner);
            Eigen::VectorXd residual = -inner.force;
            for (Index d = 0; d < u.size(); ++d)
                if (work.model.prescribed[d]) residual[d] = 0;
            Eigen::VectorXd change = Eigen::VectorXd::Zero(u.size());
            ASSERT_TRUE(tangent.factorise(u) && tangent.solve(residual, change)) << name;
            u += change;
            sizes.push_back(change.norm());
        }
        ASSERT_GE(sizes.size(), 3u) << name;
        const std::size_t n = sizes.size() - 1;
        const double order =
            std::log(sizes[n] / sizes[n - 1]) / std::log(sizes[n - 1] / sizes[n - 2]);
        EXPECT_GT(order, 1.7) << name << ": " << sizes[n - 2] << " " << sizes[n - 1] << " "
                              << sizes[n];
        EXPECT_LT(sizes[n], 1e-6) << name;
    });
}

Eigen::VectorXd slope_of(Index dofs) {
    Eigen::VectorXd w(dofs);
    for (Index d = 0; d < dofs; ++d) w[d] = std::cos(0.9 * d);
    return w;
}

double value_of(const LoadedModel& work) {
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, tight());
    EXPECT_TRUE(found.converged) << found.message;
    return slope_of(work.model.num_dofs()).dot(found.displacement);
}

template <class Number>
double difference(const LoadedModel& work, double step, const Number& number) {
    LoadedModel up = work, down = work;
    number(up) += step;
    number(down) -= step;
    return (value_of(up) - value_of(down)) / (2 * step);
}

TEST(FollowingPressure, GradientsAreThoseOfCentralDifferences) {
    for_each_mesh([](const SolidMesh& mesh, const std::string& name) {
        LoadedModel work = bent(mesh, 1.0);
        Index free = 0, wall = 0;
        for (Index d = 0; d < work.model.num_dofs(); ++d) {
            if (!work.model.prescribed[d] && d % 7 == 1) free = d;
            if (work.model.prescribed[d] && d % 3 == 1) wall = d;
        }
        work.loads.force[free] = 0.1;
        const SolidAssembly solid(work.model);
        const Equilibrium found = solve_equilibrium(solid, work.loads, tight());
        ASSERT_TRUE(found.converged) << name;
        const Eigen::VectorXd slope = slope_of(work.model.num_dofs());
        const SolidGradient gradient = solid_gradient(solid, found, slope);
        const auto expect = [&](const char* what, double value, double expected) {
            EXPECT_NEAR(value, expected, 1e-5 * std::abs(expected) + 1e-8) << name << ": " << what;
        };
        const auto columns = parameter_columns(solid, found);
        for (int k = 0; k < 2; ++k) {
            const double expected = difference(
                work, 1e-4 * soft.parameters[k],
                [k](LoadedModel& w) -> double& { return w.model.materials[0].parameters[k]; });
            expect("parameter", gradient.parameters[0][k], expected);
            expect("column", columns[0].col(k).dot(slope), expected);
        }
        expect("pressure", gradient.pressure_kpa[0],
               difference(work, 1e-4,
                          [](LoadedModel& w) -> double& { return w.loads.pressure_kpa[0]; }));
        expect(
            "force", gradient.force[free],
            difference(work, 1e-4, [=](LoadedModel& w) -> double& { return w.loads.force[free]; }));
        expect("wall", gradient.displacement[wall],
               difference(work, 1e-5,
                          [=](LoadedModel& w) -> double& { return w.loads.displacement[wall]; }));
    });
}

TEST(FollowingPressure, GradientsThroughAHistoryAreThoseOfCentralDifferences) {
    for_each_mesh([](const SolidMesh& mesh, const std::string& name) {
        LoadedModel work = bent(mesh, 1.0);
        work.model.materials[0].relaxation = {{0.8, 0.5}};
        const double kpa[] = {0.5, 1.0, 0.7};
        const auto value = [&](const LoadedModel& with, HistoryGradient* gradient) {
            std::vector<LoadTime> times;
            for (int i = 0; i < 3; ++i) {
                times.push_back({0.5 * (i + 1), with.loads});
                times[i].loads.pressure_kpa = {kpa[i] * with.loads.pressure_kpa[0]};
            }
            const auto states = solve_history(with.model, times, tight());
            double sum = 0;
            std::vector<Eigen::VectorXd> slopes;
            for (std::size_t i = 0; i < states.size(); ++i) {
                EXPECT_TRUE(states[i].converged) << name << ": " << states[i].message;
                slopes.push_back((1.0 + i) * slope_of(with.model.num_dofs()));
                sum += slopes[i].dot(states[i].displacement);
            }
            if (gradient) *gradient = history_gradient(with.model, times, states, slopes);
            return sum;
        };
        HistoryGradient gradient;
        value(work, &gradient);
        constexpr double step = 1e-4;
        const auto slope = [&](auto&& number) {
            LoadedModel up = work, down = work;
            number(up) += step;
            number(down) -= step;
            return (value(up, nullptr) - value(down, nullptr)) / (2 * step);
        };
        double by_pressure = 0;
        for (int i = 0; i < 3; ++i) by_pressure += kpa[i] * gradient.pressure_kpa[i][0];
        const double expected =
            slope([](LoadedModel& w) -> double& { return w.loads.pressure_kpa[0]; });
        EXPECT_NEAR(by_pressure, expected, 1e-5 * std::abs(expected)) << name;
        const double by_stiffness =
            slope([](LoadedModel& w) -> double& { return w.model.materials[0].parameters[0]; });
        EXPECT_NEAR(gradient.parameters[0][0], by_stiffness, 1e-5 * std::abs(by_stiffness)) << name;
        const double by_time = slope(
            [](LoadedModel& w) -> double& { return w.model.materials[0].relaxation[0].time_s; });
        EXPECT_NEAR(gradient.relaxation[0][0].time_s, by_time, 1e-5 * std::abs(by_time)) << name;
    });
}

TEST(FollowingPressure, ADampedMotionEndsInEquilibrium) {
    const LoadedModel work = bent(pressed_meshes()[2], 1.0);
    const Equilibrium expected = solve_equilibrium(SolidAssembly(work.model), work.loads, {});
    ExplicitOptions options;
    options.density_kg_per_m3 = 1e6;
    options.damping_per_s = 10;
    const ExplicitHistory found =
        solve_explicit(work.model, {{1, work.loads}, {10, work.loads}}, options);
    ASSERT_TRUE(found.is_complete) << found.message;
    EXPECT_LT((found.states.back().displacement - expected.displacement).norm(),
              1e-4 * expected.displacement.norm());
}

TEST(FollowingPressure, WhatDoesNotFitIsRefused) {
    const SolidMesh mesh = pressed_meshes()[0];
    EXPECT_THROW(check_model(with_pressure(mesh, {{{0, 1}}})), Error);
    EXPECT_THROW(check_model(with_pressure(mesh, {{{0, 1, 1000}}})), Error);
    LoadedModel work = bent(mesh, 1.0);
    work.loads.pressure_kpa = {1, 2};
    EXPECT_THROW(solve_equilibrium(SolidAssembly(work.model), work.loads, {}), Error);
    work.loads.pressure_kpa = {std::nan("")};
    EXPECT_THROW(solve_equilibrium(SolidAssembly(work.model), work.loads, {}), Error);
}

}  // namespace
}  // namespace palpate
