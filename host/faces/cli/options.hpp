// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "host/geometry/meshing/mesher.hpp"
#include "solver/linear/linear_solver.hpp"
#include "solver/linear/matrix_solver.hpp"

namespace palpate {

/// Options that several commands share, as the user typed them.
struct SolverArguments {
    std::string backend = "auto";
    std::string device;
    std::string precision = "single";
    std::string product = "auto";
    std::string linear_solver = "auto";
    std::string factorisation = "auto";
};

struct MesherArguments {
    std::string mesher = "auto";
    Index nodes = 6000;
    double time_limit_s = 120;
    double memory_limit_gib = 8;
};

void add_solver_options(CLI::App& command, SolverArguments& arguments);
/// Those of them that tangents at large deformation know: all but --product.
void add_tangent_options(CLI::App& command, SolverArguments& arguments);
void add_mesher_options(CLI::App& command, MesherArguments& arguments);

/// "auto" takes OpenCL if this build has it. Throws Error(device_unavailable) if it then finds no
/// device: nothing falls back silently.
LinearSolverOptions solver_options(const SolverArguments& arguments);
/// "auto" needs no device: the host factorises where there is none. A back end, a device or
/// conjugate gradients that were asked for by name are looked for before any work, and
/// Error(device_unavailable) says that they are missing.
MatrixSolverOptions tangent_options(const SolverArguments& arguments);
MesherOptions mesher_options(const MesherArguments& arguments);

}  // namespace palpate
