// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/linear_problem.hpp"

namespace palpate::bench {

/// Another library's solver on K of the free dofs. All of them get the same matrix and the same
/// right-hand sides and stop at the same relative residual.
class Peer {
public:
    virtual ~Peer() = default;
    /// Everything that right-hand sides can share: conversion, factor, preconditioner. `matrix`
    /// outlives the peer. Throws Error(out_of_memory) or Error(solve_failed).
    virtual void set_up(const FreeMatrix& matrix) = 0;
    /// Solves K x = b to |b - K x| <= rtol |b| in every column, from x = 0; [num_rows, columns].
    /// Returns the iterations, summed over the columns; 0 for a direct solver.
    virtual int solve(const Columns& b, Columns& x, double rtol) = 0;
    /// Library, version, threads or processes.
    virtual std::string describe() const = 0;
};

struct PeerEntry {
    std::string name;
    std::function<std::unique_ptr<Peer>()> make;
};

/// Every peer found when this program was configured.
const std::vector<PeerEntry>& peer_registry();

/// Which process of a run under mpirun this is; only PETSc's solvers can share the work.
struct ParallelRun {
    int rank = 0, size = 1;
};
ParallelRun parallel_run();

}  // namespace palpate::bench
