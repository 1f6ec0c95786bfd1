// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/solid_adjoint.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "solver/base/error.hpp"
#include "solver/equilibrium/time_steps.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

using namespace fixtures;

Eigen::VectorXd weights(Index dofs) {
    Eigen::VectorXd w(dofs);
    for (Index d = 0; d < dofs; ++d) w[d] = std::cos(0.9 * d);
    return w;
}

/// J = w . u
double value_of(const LoadedModel& work) {
    EquilibriumOptions options;
    options.relative_tolerance = 1e-12;
    const Equilibrium found = solve_equilibrium(SolidAssembly(work.model), work.loads, options);
    EXPECT_TRUE(found.converged) << found.message;
    return weights(work.model.num_dofs()).dot(found.displacement);
}

TEST(SolidAdjoint, GradientsAreThoseOfCentralDifferences) {
    for (const SolidModel& model : solid_models()) {
        const SolidMaterial& material = model.materials[0];
        const LoadedModel work = pulled(model);
        const SolidAssembly solid(work.model);
        EquilibriumOptions options;
        options.relative_tolerance = 1e-12;
        const Equilibrium found = solve_equilibrium(solid, work.loads, options);
        ASSERT_TRUE(found.converged) << name_of(work.model) << ": " << found.message;
        const SolidGradient gradient = solid_gradient(solid, found, weights(work.model.num_dofs()));

        for (std::size_t k = 0; k < material.parameters.size(); ++k) {
            const double step = 1e-4 * material.parameters[k];
            LoadedModel up = work, down = work;
            up.model.materials[0].parameters[k] += step;
            down.model.materials[0].parameters[k] -= step;
            const double expected = (value_of(up) - value_of(down)) / (2 * step);
            EXPECT_NEAR(gradient.parameters[0][k], expected, 1e-5 * std::abs(expected) + 1e-9)
                << name_of(work.model) << " parameter " << k;
        }
        // Prescribed displacements and forces.
        for (Index d = 0; d < work.model.num_dofs(); ++d) {
            const bool is_wall = work.loads.displacement[d] != 0;
            const bool is_free = !work.model.prescribed[d];
            if (!is_wall && !(is_free && d % 7 == 1)) continue;
            constexpr double step = 1e-4;
            LoadedModel up = work, down = work;
            (is_wall ? up.loads.displacement : up.loads.force)[d] += step;
            (is_wall ? down.loads.displacement : down.loads.force)[d] -= step;
            const double expected = (value_of(up) - value_of(down)) / (2 * step);
            EXPECT_NEAR((is_wall ? gradient.displacement : gradient.force)[d], expected,
                        1e-5 * std::abs(expected) + 1e-7)
                << name_of(work.model) << " dof " << d;
        }
    }
}

TEST(SolidAdjoint, AnObjectiveOfTheWrongSizeIsRefused) {
    const LoadedModel work = pulled(solid_models()[2]);
    const SolidAssembly solid(work.model);
    const Equilibrium found = solve_equilibrium(solid, work.loads, {});
    EXPECT_THROW(solid_gradient(solid, found, Eigen::VectorXd::Zero(3)), Error);
}

TEST(SolidAdjoint, AStateOfALoadHistoryHasNoGradientYet) {
    const LoadedModel work = pulled(solid_models()[2]);
    const auto states = solve_history(work.model, {{1, work.loads}}, {});
    EXPECT_THROW(solid_gradient(SolidAssembly(work.model), states[0],
                                Eigen::VectorXd::Ones(work.model.num_dofs())),
                 Error);
}

}  // namespace
}  // namespace palpate
