// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/meshing/mesher.hpp"
#include "host/io/option_values.hpp"
#include "solver/equilibrium/newton.hpp"
#include "solver/linear/linear_solver.hpp"

// Parts of tables of options that several applications share: who computes, and how meshes are
// made.
namespace palpate {

/// "backend", "device", "precision", "linear_solver", "factorisation": what tangents at large
/// deformation know.
std::vector<Option> tangent_options();
/// The same and "product", which is of the linear law.
std::vector<Option> solver_options();
/// "mesher", "nodes" (usually `num_nodes`), "mesh_time_limit", "mesh_memory_limit", "mesh_program".
std::vector<Option> mesher_options(Index num_nodes = MesherOptions{}.num_nodes);
/// Parts of a table in one.
std::vector<Option> joined(std::initializer_list<std::vector<Option>> parts);

/// Of values with `solver_options`. "auto" takes OpenCL if this build has it. Throws
/// Error(device_unavailable) if it then finds no device, Error(unsupported) for what this build
/// lacks: nothing falls back silently.
LinearSolverOptions solver_of(const OptionValues& values);
/// How `newton` solves with tangents and where its element loops run, of values with
/// `tangent_options`. "auto" needs no device: the host factorises where there is
/// none. A back end, a device or conjugate gradients that were asked for by name are looked for
/// before any work, and Error(device_unavailable) says that they are missing.
void take_tangent_options(const OptionValues& values, EquilibriumOptions& newton);
/// Of values with an option "jobs": the cores, if it is not given.
int jobs_of(const OptionValues& values);
/// Of values with `mesher_options`.
MesherOptions mesher_of(const OptionValues& values);

}  // namespace palpate
