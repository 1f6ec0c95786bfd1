// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bench/bench_mesh.hpp"

namespace palpate::bench {

/// K on the free dofs: the matrix of every peer. Compressed rows, both triangles, column numbers
/// ascending; the three dofs of a node follow each other.
struct FreeMatrix {
    std::vector<Index> dofs;     ///< [num_rows] of the model
    std::vector<Index> offsets;  ///< [num_rows + 1]
    std::vector<Index> columns;
    std::vector<double> values;     ///< mN/mm
    std::vector<Vec3> coordinates;  ///< [num_rows / 3] of the free nodes, mm

    Index num_rows() const { return static_cast<Index>(dofs.size()); }
};

/// Throws Error(unsupported) if a node is prescribed in part: peers work on blocks of three rows.
FreeMatrix assemble_free_matrix(const Model& model);

/// Right-hand sides that a patient could ask for. Column c: the wall motion of the mesh, for c > 0
/// times a smooth random factor of 0.5 to 1.5 per component, and a smooth random body force whose
/// nodal forces are, in the norm, as large as those that the wall motion induces.
struct LinearProblem {
    Columns b;                      ///< [num_dofs, columns] as `LinearSolver::solve` takes it
    std::vector<double> rhs_norms;  ///< [columns] |free_rhs|
};

/// The same for the same mesh; its first columns do not depend on the number of columns.
LinearProblem make_linear_problem(const BenchMesh& mesh, Index columns);

/// f = K u element by element, no dof prescribed; [num_dofs, columns].
Columns internal_forces(const Model& model, const Columns& u);

/// b - K u at free dofs, with u the prescribed part of b; 0 at prescribed dofs.
Columns free_rhs(const Model& model, const Columns& b);

/// Largest |b - K x| / rhs_norm of all columns over the free dofs: the judge of every solver,
/// which shares no code with any of them. Infinite if x misses a prescribed displacement.
double relative_residual(const Model& model, const LinearProblem& problem, const Columns& x);

}  // namespace palpate::bench
