// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/multigrid/hierarchy.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <set>

#include "solver/linear/multigrid/aggregates.hpp"
#include "solver/model/stiffness_matrix.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

using Dense = Eigen::MatrixXd;

Dense dense(const BlockMatrix& matrix) {
    Dense result = Dense::Zero(matrix.num_rows() * matrix.block_rows,
                               matrix.num_columns * matrix.block_columns);
    for (Index n = 0; n < matrix.num_rows(); ++n)
        for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k)
            for (int i = 0; i < matrix.block_rows; ++i)
                for (int j = 0; j < matrix.block_columns; ++j)
                    result(n * matrix.block_rows + i,
                           matrix.graph.items[k] * matrix.block_columns + j) =
                        matrix.block(k)[matrix.block_columns * i + j];
    return result;
}

/// A row of six nodes.
Adjacency chain(Index count) {
    Adjacency graph;
    graph.offsets = {0};
    for (Index n = 0; n < count; ++n) {
        for (Index m = std::max(0, n - 1); m <= std::min(count - 1, n + 1); ++m)
            graph.items.push_back(m);
        graph.offsets.push_back(static_cast<Index>(graph.items.size()));
    }
    return graph;
}

TEST(Aggregates, AreNeighbourhoodsThatTouchNoOtherAndTheRestJoinsThem) {
    const std::vector<unsigned char> all(6, 1);

    const Aggregates aggregates = aggregate_nodes(chain(6), all);

    // Roots 0, 2 (touches 1: taken), 3 ...: {0, 1}, then {2, 3, 4} round 3, and 5 joins it.
    EXPECT_EQ(aggregates.count, 2);
    EXPECT_EQ(aggregates.of_node, (std::vector<Index>{0, 0, 1, 1, 1, 1}));
}

TEST(Aggregates, LeaveOutNodesWithoutFreeDofs) {
    const std::vector<unsigned char> some = {0, 1, 1, 0, 1, 0};

    const Aggregates aggregates = aggregate_nodes(chain(6), some);

    EXPECT_EQ(aggregates.of_node, (std::vector<Index>{-1, 0, 0, -1, 1, -1}));
}

TEST(Hierarchy, EveryFreeNodeHasOneAggregateAndEveryAggregateHangsTogether) {
    const Model model = fixtures::two_tissue_model({9, 10, 11});
    const StiffnessMatrix stiffness = assemble_stiffness(model);

    const Hierarchy hierarchy(model, stiffness);

    ASSERT_GE(hierarchy.levels().size(), 2u);
    const Aggregates& aggregates = hierarchy.levels()[0].aggregates;
    std::set<Index> seen;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        EXPECT_EQ(aggregates.of_node[n] < 0, model.prescribed[3 * n] != 0) << n;
        seen.insert(aggregates.of_node[n]);
    }
    seen.erase(-1);
    EXPECT_EQ(static_cast<Index>(seen.size()), aggregates.count);
    EXPECT_LT(10 * aggregates.count, model.mesh.num_nodes());
}

TEST(Hierarchy, CoarseMatricesAreGalerkinProducts) {
    const Model model = fixtures::two_tissue_model({6, 7, 8});
    const StiffnessMatrix stiffness = assemble_stiffness(model);

    const Hierarchy hierarchy(model, stiffness);

    Dense constrained = dense(stiffness);
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) {
            constrained.row(d).setZero();
            constrained.col(d).setZero();
            constrained(d, d) = 1;
        }
    const Dense p = dense(hierarchy.levels()[0].prolongation);
    Dense expected = p.transpose() * constrained * p;
    for (Index d = 0; d < expected.rows(); ++d)
        if (expected(d, d) <= 0) expected(d, d) = 1;  // a mode that an aggregate lacks
    const Dense actual = dense(hierarchy.levels()[1].matrix);
    EXPECT_LT((actual - expected).norm(), 1e-12 * expected.norm());
    EXPECT_EQ(dense(transposed(hierarchy.levels()[0].prolongation)), p.transpose());
    EXPECT_LT((hierarchy.coarsest_inverse() * dense(hierarchy.levels().back().matrix) -
               Dense::Identity(actual.rows(), actual.cols()))
                  .norm(),
              1e-8);
}

TEST(Hierarchy, ProlongationReproducesRigidMotionsAwayFromPrescribedDofs) {
    Model model = fixtures::two_tissue_model({8, 8, 9});
    std::fill(model.prescribed.begin(), model.prescribed.end(), 0);
    for (Index n : {0, 1, 9})  // three nodes of one corner
        std::fill_n(model.prescribed.begin() + 3 * n, 3, 1);
    const StiffnessMatrix stiffness = assemble_stiffness(model);

    const Hierarchy hierarchy(model, stiffness);

    // K B = 0 for rigid motions B, so the smoothed prolongation maps their coarse form onto them.
    const auto& level = hierarchy.levels()[0];
    const Dense rigid = dense(level.prolongation) * hierarchy.levels()[1].modes;
    double worst = 0;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        if (model.mesh.nodes[n].norm() > 0.5 * model.mesh.nodes.back().norm())
            worst = std::max(
                worst, (rigid.middleRows<3>(3 * n) - level.modes.middleRows<3>(3 * n)).norm());
    EXPECT_LT(worst, 1e-10);
}

TEST(Hierarchy, NewModuliGiveTheSameValuesAsANewHierarchy) {
    Model model = fixtures::two_tissue_model({9, 10, 11});
    Hierarchy updated(model, assemble_stiffness(model));
    updated.drop_values();
    model.materials[1].stiffness_kpa *= 50;
    const StiffnessMatrix stiffness = assemble_stiffness(model);

    updated.update(stiffness);

    const Hierarchy fresh(model, stiffness);
    ASSERT_EQ(updated.levels().size(), fresh.levels().size());
    for (std::size_t l = 0; l < fresh.levels().size(); ++l) {
        EXPECT_EQ(updated.levels()[l].matrix.blocks, fresh.levels()[l].matrix.blocks);
        EXPECT_EQ(updated.levels()[l].prolongation.blocks, fresh.levels()[l].prolongation.blocks);
        EXPECT_EQ(updated.levels()[l].largest_eigenvalue, fresh.levels()[l].largest_eigenvalue);
    }
    EXPECT_EQ(updated.coarsest_inverse(), fresh.coarsest_inverse());
}

TEST(Hierarchy, EigenvalueEstimateIsNearTheLargest) {
    const Model model = fixtures::two_tissue_model({5, 5, 6});
    const StiffnessMatrix stiffness = assemble_stiffness(model);
    const Hierarchy hierarchy(model, stiffness);
    const auto& level = hierarchy.levels()[0];
    Dense constrained = dense(stiffness);
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) {
            constrained.row(d).setZero();
            constrained.col(d).setZero();
            constrained(d, d) = 1;
        }
    Dense inverse = Dense::Zero(model.num_dofs(), model.num_dofs());
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        inverse.block<3, 3>(3 * n, 3 * n) = Eigen::Map<const Eigen::Matrix3d>(
            &level.inverse_diagonal[9 * static_cast<std::size_t>(n)]);

    const double exact =
        Eigen::EigenSolver<Dense>(inverse * constrained, false).eigenvalues().cwiseAbs().maxCoeff();

    EXPECT_NEAR(level.largest_eigenvalue, exact, 0.1 * exact);
}

}  // namespace
}  // namespace palpate
