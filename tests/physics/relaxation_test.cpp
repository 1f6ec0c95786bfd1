// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "solver/base/error.hpp"
#include "solver/equilibrium/time_steps.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

const std::vector<RelaxationTerm> terms{{0.8, 0.5}, {0.4, 6.0}};

const std::vector<SolidMaterial>& materials() {
    static const std::vector<SolidMaterial> list{{"linear", {10, 0.3}, terms},
                                                 {"neo-hookean", {10, 0.35}, terms},
                                                 {"neo-hookean-reduced", {2, 20}, terms},
                                                 {"veronda-westmann", {1.5, 3, 25}, terms},
                                                 {"reduced-polynomial", {1.5, 2, 0.1}, terms}};
    return list;
}

/// A block between two plates that hold it sideways too. With one law everywhere and the plates
/// still, the strains stay as they are and all stresses relax as G(t).
struct Block {
    SolidModel model;
    SolidLoads pressed;
    double force_of(const Equilibrium& state) const {
        double sum = 0;
        for (Index n = 0; n < model.mesh.num_nodes(); ++n)
            if (model.mesh.nodes[n].z() > 2 - 1e-9) sum += state.reaction[3 * n + 2];
        return sum;
    }
};

Block make_block(const SolidMaterial& material, VolumeTreatment volume) {
    const SolidMesh mesh =
        with_edge_nodes(solid_mesh_of(fixtures::box_mesh({2, 2, 2}, Vec3(2, 2, 2))));
    SolidModel model = fixtures::solid_model(mesh, material);
    model.volume = volume;
    auto [held, loads] = fixtures::between_plates(std::move(model), Vec3(0, 0, -0.3));
    return {std::move(held), std::move(loads)};
}

/// The force after an endless time: that of the law alone.
double force_at_rest(SolidMaterial material, VolumeTreatment volume) {
    material.relaxation.clear();
    const Block block = make_block(material, volume);
    return block.force_of(solve_equilibrium(SolidAssembly(block.model), block.pressed, {}));
}

// Pressed within 1e-6 s and held.
TEST(Relaxation, AfterASuddenStrainTheForceFollowsTheRelaxationFunction) {
    for (const SolidMaterial& material : materials())
        for (const auto volume : {VolumeTreatment::pointwise, VolumeTreatment::element_mean}) {
            const Block block = make_block(material, volume);
            std::vector<LoadTime> times;
            for (const double t : {1e-6, 0.2, 0.7, 2.0, 9.0, 40.0})
                times.push_back({t, block.pressed});

            const auto states = solve_history(block.model, times, {});

            ASSERT_EQ(states.size(), times.size()) << material.law;
            for (std::size_t k = 0; k < times.size(); ++k) {
                ASSERT_TRUE(states[k].converged) << material.law << ": " << states[k].message;
                double relaxation = 1;
                for (const RelaxationTerm& term : terms)
                    relaxation += term.amplitude * std::exp(-times[k].time_s / term.time_s);
                EXPECT_NEAR(block.force_of(states[k]) / force_at_rest(material, volume), relaxation,
                            1e-5)
                    << material.law << " after " << times[k].time_s << " s";
            }
        }
}

// For the linear law everything is proportional to the plates' motion, so that a ramp is exact with
// any steps: F(t) / F = t + sum_k C_k tau_k (1 - exp(-t / tau_k)) for a ramp of one per second.
TEST(Relaxation, ARampIsExactWhateverTheSteps) {
    const auto volume = VolumeTreatment::pointwise;
    const Block block = make_block(materials()[0], volume);
    std::vector<LoadTime> times;
    for (const double t : {0.03, 0.3, 0.35, 1.0})
        times.push_back({t, {t * block.pressed.displacement, block.pressed.force}});

    const auto states = solve_history(block.model, times, {});

    ASSERT_EQ(states.size(), times.size());
    for (std::size_t k = 0; k < times.size(); ++k) {
        const double t = times[k].time_s;
        double expected = t;
        for (const RelaxationTerm& term : terms)
            expected += term.amplitude * term.time_s * -std::expm1(-t / term.time_s);
        EXPECT_NEAR(block.force_of(states[k]) / force_at_rest(materials()[0], volume), expected,
                    1e-9)
            << t;
    }
}

// In plane stress the thickness creeps with the history, so the stress across stays nothing.
TEST(Relaxation, APlateInPlaneStressRelaxesAlike) {
    for (const SolidMaterial& material : materials()) {
        SolidModel model{fixtures::rectangle_mesh(ElementType::tri3, Formulation::plane_stress,
                                                  {2, 2}, {2.0, 2.0}),
                         {material},
                         {}};
        model.prescribed.assign(3 * model.mesh.nodes.size(), 1);
        SolidLoads loads{Eigen::VectorXd::Zero(model.num_dofs()),
                         Eigen::VectorXd::Zero(model.num_dofs())};
        for (Index n = 0; n < model.mesh.num_nodes(); ++n)
            loads.displacement[3 * n] = 0.1 * model.mesh.nodes[n].x();
        const auto pull = [&](const Equilibrium& state) {
            double sum = 0;
            for (Index n = 0; n < model.mesh.num_nodes(); ++n)
                if (model.mesh.nodes[n].x() > 2 - 1e-9) sum += state.reaction[3 * n];
            return sum;
        };
        const auto states = solve_history(model, {{1e-6, loads}, {3, loads}, {500, loads}}, {});
        ASSERT_EQ(states.size(), 3u);
        EXPECT_NEAR(pull(states[0]) / pull(states[2]), 2.2, 1e-4) << material.law;
    }
}

TEST(Relaxation, BadTimesAndTermsAreRefused) {
    const Block block = make_block(materials()[1], VolumeTreatment::pointwise);
    EXPECT_THROW(solve_history(block.model, {{0, block.pressed}}, {}), Error);
    EXPECT_THROW(solve_history(block.model, {{2, block.pressed}, {1, block.pressed}}, {}), Error);
    SolidModel wrong = block.model;
    wrong.materials[0].relaxation = {{0.5, 0}};
    EXPECT_THROW(solve_history(wrong, {{1, block.pressed}}, {}), Error);
    wrong.materials[0].relaxation = {{-0.5, 1}};
    EXPECT_THROW(solve_history(wrong, {{1, block.pressed}}, {}), Error);
}

}  // namespace
}  // namespace palpate
