// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/viscous_history.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/model/block_product.hpp"
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

/// A smooth displacement of some hundredths, zero at prescribed components that planes and axes
/// ask for.
Eigen::VectorXd waves(const SolidModel& model, double phase) {
    Eigen::VectorXd u(model.num_dofs());
    for (Index d = 0; d < model.num_dofs(); ++d)
        u[d] = model.prescribed[d] ? 0 : 0.03 * std::sin(phase + 1.3 * d);
    return u;
}

// The second of two steps, with histories that differ from its stress.
TEST(ViscousHistory, ForcesAreTheSlopeOfTheEnergyAndTheTangentThatOfTheForces) {
    constexpr double step = 1e-5;
    for (SolidModel model : fixtures::solid_models())
        for (const auto which : {RelaxationOf::total, RelaxationOf::isochoric}) {
            SolidMaterial& material = model.materials[0];
            material.relaxation = terms;
            material.relaxation_of = which;
            material.is_instantaneous = which == RelaxationOf::isochoric;
            SolidAssembly solid(model);
            ViscousHistory history(model);
            history.begin_step(dt_s, solid);
            history.end_step(dt_s, solid, waves(model, 0.3));
            history.begin_step(dt_s, solid);
            const Eigen::VectorXd u = waves(model, 1.1), along = waves(model, 2.5);

            const InternalForce at = solid.internal_force(u);
            const InternalForce up = solid.internal_force(u + step * along);
            const InternalForce down = solid.internal_force(u - step * along);
            BlockMatrix tangent = solid.make_matrix();
            solid.tangent(u, tangent);

            ASSERT_TRUE(at.is_valid);
            const double slope = (up.energy - down.energy) / (2 * step);
            EXPECT_NEAR(at.force.dot(along), slope, 1e-7 * (1 + std::abs(slope)))
                << fixtures::name_of(model);
            const Eigen::VectorXd change = (up.force - down.force) / (2 * step);
            EXPECT_LT((times(tangent, along) - change).norm(), 1e-6 * change.norm())
                << fixtures::name_of(model);
        }
}

// Only changes of shape are stiffer at once.
TEST(ViscousHistory, IsochoricRelaxationLeavesTheVolumeElastic) {
    SolidModel model = relaxing_model();
    Eigen::VectorXd swollen(model.num_dofs());
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        swollen.segment<3>(3 * n) = 0.02 * model.mesh.nodes[n];
    for (const SolidMaterial& bare : fixtures::solid_materials()) {
        model.materials[0] = bare;
        const double lasting = SolidAssembly(model).internal_force(swollen).energy;
        model.materials[0].relaxation = terms;
        model.materials[0].relaxation_of = RelaxationOf::isochoric;
        SolidAssembly solid(model);
        ViscousHistory history(model);
        history.begin_step(1e-9, solid);

        EXPECT_NEAR(solid.internal_force(swollen).energy, lasting, 1e-9 * lasting) << bare.law;
        for (const Tensor3<double>& stress : solid.relaxing_stress(swollen))
            EXPECT_LT(double_dot(stress, stress), 1e-20) << bare.law;
    }
}

TEST(ViscousHistory, InstantaneousModuliAreThoseOfASuddenStrain) {
    SolidModel model = relaxing_model();
    model.materials[0].is_instantaneous = true;
    SolidAssembly elastic(fixtures::solid_model(model.mesh, fixtures::solid_materials().front()));
    SolidAssembly solid(model);
    const ViscousHistory history(model);
    const Eigen::VectorXd u = strained(model);
    const double sudden = elastic.internal_force(u).force.norm();

    history.begin_step(1e-9, solid);
    EXPECT_NEAR(solid.internal_force(u).force.norm() / sudden, 1.0, 1e-6);
    history.begin_step(1e9, solid);
    EXPECT_NEAR(solid.internal_force(u).force.norm() / sudden, 1 / 1.9, 1e-6);
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
