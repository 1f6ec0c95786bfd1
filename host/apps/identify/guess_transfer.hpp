// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/apps/simulate/run_simulation.hpp"

namespace palpate {

/// Displacements of a run on the cells and at the times of another one, for that one to begin with:
/// linear between times, and between the lines of a graded mesh whose cells are twice or half as
/// large (`halve_cells`, `double_cells`).
///   settings      of the other run
///   from          a run that came to its end
///   displacement  [states of `from`][3 num_nodes] mm, rest first
/// [times of the other run][3 num_nodes]; empty where cells or loads differ in another way.
std::vector<Eigen::VectorXd> transferred_guesses(const SimulationSettings& settings,
                                                 const SimulationResult& from,
                                                 const std::vector<Eigen::VectorXd>& displacement);

}  // namespace palpate
