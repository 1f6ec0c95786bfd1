// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/linear_problem.hpp"

namespace palpate::bench {

constexpr double relative_tolerance = 1e-8;  ///< on |b - K x| / |b| of every column, for everyone

/// One solver on one problem, ours or a peer. `set_up` and `solve` are what is timed.
class Contender {
public:
    virtual ~Contender() = default;
    virtual void set_up() = 0;
    virtual double solve() = 0;          ///< returns the mean number of iterations per column
    virtual Columns answer() const = 0;  ///< [num_dofs, columns]
    virtual std::string describe() const = 0;
};

struct ContenderEntry {
    std::string name;
    bool shares_work_among_processes = false;  ///< under mpirun the others do not run
    Index most_dofs = 0;                       ///< larger meshes are left out; 0: none are
    /// Mesh and problem outlive the contender. Brings the problem into the form that the solver
    /// takes, which is not timed: peers find K assembled, our solvers assemble in `set_up`.
    std::function<std::unique_ptr<Contender>(const BenchMesh&, const LinearProblem&)> make;
};

std::vector<ContenderEntry> contenders();

}  // namespace palpate::bench
