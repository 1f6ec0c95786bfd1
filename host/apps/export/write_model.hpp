// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "host/apps/export/recovered_model.hpp"

namespace palpate {

/// What moves the walls of driven organs in the exported problem; both have the same answer.
enum class WallLoad {
    displacement,  ///< the recovered displacement of each node
    force,         ///< the recovered force on each node
};

/// FEBio 4 (.feb): mm, MPa, N. The law "neo-hookean" is FEBio's "neo-Hookean" exactly; "linear"
/// becomes its "isotropic elastic" (St. Venant-Kirchhoff), because FEBio has no analysis at small
/// strains: the same at small strains only. Throws Error(unsupported) for laws that FEBio has not.
std::string febio_model(const RecoveredModel& model, WallLoad load);

/// Abaqus's input language as CalculiX reads it (.inp): mm, MPa, N. "linear" is *ELASTIC at small
/// strains exactly, others are *HYPERELASTIC where CalculiX has them (law_formats.cpp). Throws
/// Error(unsupported) for the rest; the nearest to "neo-hookean" part the energy otherwise, and
/// were 3 % of the displacement off.
std::string abaqus_deck(const RecoveredModel& model, WallLoad load);

/// Gmsh 4.1, ASCII (.msh): one physical volume per region, node data `displacement` (mm), `force`
/// (mN), `held`, element data `stiffness_kpa`, `poisson_ratio`.
std::string gmsh_mesh(const RecoveredModel& model);

/// Writes .feb, .inp, .msh or .vtu, by the ending of `path`, all or nothing. The .vtu has palpate's
/// own units and the arrays of the result's mesh.vtu, with `poisson_ratio` beside.
/// Throws Error(unsupported) for another ending, Error(output_failed).
void write_model(const RecoveredModel& model, WallLoad load, const std::filesystem::path& path);

}  // namespace palpate
