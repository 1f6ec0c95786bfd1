// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/viscous_history.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

constexpr double dt_s = 0.4;
const std::vector<RelaxationTerm> terms{{0.6, 1.5}, {0.3, 0.2}};

SolidModel relaxing_model() {
    SolidMaterial material = fixtures::solid_materials().front();
    material.relaxation = terms;
    return fixtures::solid_model(fixtures::solid_meshes().front(), material);
}

/// A stretch with shear, of some per cent.
Eigen::VectorXd strained(const SolidModel& model) {
    Eigen::VectorXd u(model.num_dofs());
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        u.segment<3>(3 * n) = Vec3(0.04 * x[0] + 0.02 * x[1], -0.01 * x[1], 0.01 * x[2]);
    }
    return u;
}

/// Part of a ramp of length dt that is left at its end, over its height: c = C (1 - e^-x) / x.
double left_of_ramp(const RelaxationTerm& term) {
    const double x = dt_s / term.time_s;
    return term.amplitude * (1 - std::exp(-x)) / x;
}

TEST(ViscousHistory, HeldStrainRelaxesByItsExponentials) {
    const SolidModel model = relaxing_model();
    SolidAssembly elastic(fixtures::solid_model(model.mesh, fixtures::solid_materials().front()));
    SolidAssembly solid(model);
    ViscousHistory history(model);
    const Eigen::VectorXd u = strained(model);
    const Eigen::VectorXd lasting = elastic.internal_force(u).force;
    ASSERT_GT(lasting.norm(), 1e-6);

    for (int step = 0; step < 6; ++step) {
        history.begin_step(dt_s, solid);

        // 1 + sum c_k exp(-t / tau_k), t since the ramp ended: the same for all components.
        double expected = 1;
        for (const RelaxationTerm& term : terms)
            expected += left_of_ramp(term) * std::exp(-step * dt_s / term.time_s);
        const Eigen::VectorXd force = solid.internal_force(u).force;
        EXPECT_LT((force - expected * lasting).norm(), 1e-10 * lasting.norm()) << "step " << step;
        history.end_step(dt_s, solid, u);
    }
}

TEST(ViscousHistory, ASuddenStrainIsStifferByAllAmplitudesAndASlowOneByNone) {
    const SolidModel model = relaxing_model();
    SolidAssembly elastic(fixtures::solid_model(model.mesh, fixtures::solid_materials().front()));
    SolidAssembly solid(model);
    const ViscousHistory history(model);
    const Eigen::VectorXd u = strained(model);
    const double lasting = elastic.internal_force(u).force.norm();

    history.begin_step(1e-9, solid);
    EXPECT_NEAR(solid.internal_force(u).force.norm() / lasting, 1.9, 1e-6);
    history.begin_step(1e9, solid);
    EXPECT_NEAR(solid.internal_force(u).force.norm() / lasting, 1.0, 1e-6);
}

TEST(ViscousHistory, RemembersNothingOfElasticMaterial) {
    const SolidModel model = fixtures::solid_model(fixtures::solid_meshes().front(),
                                                   fixtures::solid_materials().front());
    SolidAssembly solid(model);
    ViscousHistory history(model);

    history.begin_step(dt_s, solid);
    history.end_step(dt_s, solid, strained(model));

    EXPECT_FALSE(has_relaxation(model));
    EXPECT_TRUE(has_relaxation(relaxing_model()));
    for (const Tensor3<double>& stress : history.stress()) EXPECT_EQ(double_dot(stress, stress), 0);
}

TEST(ViscousHistory, AddsUpOverTermsAndIsLinearInAmplitudes) {
    const Eigen::VectorXd u = strained(relaxing_model());
    // Energy of a third step after a stretch and half a release.
    const auto energy = [&](const std::vector<RelaxationTerm>& of) {
        SolidModel model = relaxing_model();
        model.materials[0].relaxation = of;
        SolidAssembly solid(model);
        ViscousHistory history(model);
        for (const double part : {1.0, 0.5}) {
            history.begin_step(dt_s, solid);
            history.end_step(dt_s, solid, part * u);
        }
        history.begin_step(dt_s, solid);
        return solid.internal_force(0.7 * u).energy;
    };
    const double lasting = energy({}), both = energy(terms);
    const double first = energy({terms[0]}), second = energy({terms[1]});
    const double twice = energy({{2 * terms[0].amplitude, terms[0].time_s}});

    EXPECT_NEAR(both - lasting, (first - lasting) + (second - lasting), 1e-12);
    EXPECT_NEAR(twice - lasting, 2 * (first - lasting), 1e-12);
    EXPECT_GT(std::abs(first - lasting), 1e-3 * lasting);
}

}  // namespace
}  // namespace palpate
