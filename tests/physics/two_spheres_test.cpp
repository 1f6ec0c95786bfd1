// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "host/apps/phantom/spheres.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/linear_solvers.hpp"

namespace palpate {
namespace {

/// sigma_rr = (lambda + 2 mu) u' + 2 lambda u / r, u' from central differences.
double radial_stress(const SpheresOptions& options, double r, const LinearElastic& m) {
    const double h = 1e-4 * r;
    const double slope =
        (sphere_displacement_mm(options, r + h) - sphere_displacement_mm(options, r - h)) / (2 * h);
    const double lambda = m.stiffness_kpa * m.unit_lambda(), mu = m.stiffness_kpa * m.unit_mu();
    return (lambda + 2 * mu) * slope + 2 * lambda * sphere_displacement_mm(options, r) / r;
}

TEST(TwoSpheres, MeetInDisplacementAndStressAndCarryThePressure) {
    SpheresOptions options;
    options.inner.stiffness_kpa = 80;
    options.pressure_kpa = 1.7;
    const double a = options.inner_radius_mm, b = options.outer_radius_mm;

    EXPECT_NEAR(sphere_displacement_mm(options, a), sphere_displacement_mm(options, a + 1e-9),
                1e-8);
    EXPECT_NEAR(radial_stress(options, 0.999 * a, options.inner),
                radial_stress(options, 1.001 * a, options.outer), 0.01);
    EXPECT_NEAR(radial_stress(options, b, options.outer), -1.7, 1e-6);
}

TEST(TwoSpheres, OfOneMaterialShrinkLikeASolidBall) {
    SpheresOptions options;
    options.inner = options.outer = {20, 0.3};

    // u = -p r (1 - 2 nu) / E
    EXPECT_NEAR(sphere_displacement_mm(options, 30), -1.0 * 30 * 0.4 / 20, 1e-12);
    EXPECT_NEAR(sphere_displacement_mm(options, 37.5), -1.0 * 37.5 * 0.4 / 20, 1e-12);
}

TEST(TwoSpheres, FillTheOctantWithoutHoles) {
    const Model model = spheres_model({}, 20);

    double ball = 0, shell = 0;
    for (Index t = 0; t < model.mesh.num_tets(); ++t) {
        EXPECT_GT(tet_volume(model.mesh, t), 0);
        (model.mesh.region[t] == 0 ? ball : shell) += tet_volume(model.mesh, t);
    }
    const double octant = 3.14159265358979 / 6;
    EXPECT_NEAR(ball / (octant * std::pow(30, 3)), 1, 0.01);
    EXPECT_NEAR((ball + shell) / (octant * std::pow(37.5, 3)), 1, 0.01);
}

TEST(TwoSpheres, AreSolvedWithinOnePercentOfTheClosedForm) {
    const LinearSolverOptions solver = fixtures::solver_on("reference");
    for (const double stiffness_kpa : {10.0, 50.0, 350.0}) {
        SpheresOptions options;
        options.inner.stiffness_kpa = stiffness_kpa;

        const double exact = pressed_inner_radius_mm(options) - options.inner_radius_mm;
        const double coarse = solved_inner_radius_mm(options, 10, solver) - options.inner_radius_mm;
        const double fine = solved_inner_radius_mm(options, 20, solver) - options.inner_radius_mm;

        EXPECT_NEAR(fine / exact, 1, 0.01) << stiffness_kpa;
        EXPECT_LT(std::abs(fine - exact), 0.5 * std::abs(coarse - exact)) << stiffness_kpa;
    }
}

}  // namespace
}  // namespace palpate
