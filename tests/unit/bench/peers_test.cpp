// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "bench/peers/peer.hpp"

namespace palpate::bench {
namespace {

TEST(Peers, SolveToTheToleranceAskedFor) {
    const BenchMesh& mesh = bench_mesh("", "box");
    const LinearProblem problem = make_linear_problem(mesh, 2);
    const FreeMatrix matrix = assemble_free_matrix(mesh.model);
    const Columns b = free_rhs(mesh.model, problem.b)(matrix.dofs, Eigen::all);
    for (const PeerEntry& entry : peer_registry()) {
        const std::unique_ptr<Peer> peer = entry.make();
        peer->set_up(matrix);
        Columns x, u = problem.b;
        peer->solve(b, x, 1e-6);
        u(matrix.dofs, Eigen::all) = x;

        // Some judge by a residual that they update: it may drift a little.
        EXPECT_LT(relative_residual(mesh.model, problem, u), 1.1e-6) << entry.name;
    }
}

}  // namespace
}  // namespace palpate::bench
