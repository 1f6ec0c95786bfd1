// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/reduced_model.hpp"

#include <gtest/gtest.h>

#include "solver/base/error.hpp"
#include "tests/fixtures/small_problem.hpp"

namespace palpate {
namespace {

const std::vector<double> kpa{0, 10, 37, 85};

/// S_oo(E) and S_od(E), block by block from the regions.
struct Dense {
    Eigen::MatrixXd stiffness, coupling;
    explicit Dense(const ReducedModel& model)
        : stiffness(Eigen::MatrixXd::Zero(model.observed_dofs(), model.observed_dofs())),
          coupling(Eigen::MatrixXd::Zero(model.observed_dofs(), model.driven_dofs())) {
        for (const CondensedRegion& r : model.regions())
            for (std::size_t a = 0; a < r.observed.size(); ++a) {
                for (std::size_t b = 0; b < r.observed.size(); ++b)
                    stiffness.block<3, 3>(3 * r.observed[a], 3 * r.observed[b]) +=
                        kpa[r.region] * r.observed_observed.block<3, 3>(3 * a, 3 * b);
                for (std::size_t b = 0; b < r.driven.size(); ++b)
                    coupling.block<3, 3>(3 * r.observed[a], 3 * r.driven[b]) +=
                        kpa[r.region] * r.observed_driven.block<3, 3>(3 * a, 3 * b);
            }
    }
};

TEST(ReducedModel, SumsTheBlocksOfItsRegions) {
    SmallProblem f;
    const Dense dense(f.model);
    const Eigen::VectorXd on_driven = f.noise(f.model.driven_dofs());
    const Eigen::VectorXd on_observed = f.noise(f.model.observed_dofs());

    EXPECT_LT((f.model.stiffness(kpa) - dense.stiffness).norm(), 1e-12 * dense.stiffness.norm());
    EXPECT_LT((f.model.coupling_times(kpa, on_driven) - dense.coupling * on_driven).norm(), 1e-10);
    EXPECT_LT((f.model.transposed_coupling_times(kpa, on_observed) -
               dense.coupling.transpose() * on_observed)
                  .norm(),
              1e-10);
    EXPECT_TRUE(f.model.has_region(3));
    EXPECT_FALSE(f.model.has_region(0));
}

TEST(ReducedModel, ObservedNodesAreInEquilibrium) {
    SmallProblem f;
    const Dense dense(f.model);

    const Eigen::VectorXd u = f.model.observed_displacement(kpa, f.driven);

    EXPECT_LT((dense.stiffness * u + dense.coupling * f.driven).norm(),
              1e-10 * (dense.coupling * f.driven).norm());
    EXPECT_GT(u.norm(), 0.01);
}

TEST(ReducedModel, SaysSoWhereTissueIsNotStable) {
    SmallProblem f;

    EXPECT_THROW(f.model.observed_displacement({0, -10, 1, 1}, f.driven), Error);
}

}  // namespace
}  // namespace palpate
