// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/simulate/run_simulation.hpp"
#include "host/page/result_tree.hpp"

namespace palpate {

/// What simulation.json and the page tell: the settings with every default filled in, Newton's
/// record of each step, the resultants and messages. Units are in the names. Holds no path and no
/// file name.
ResultTree simulation_tree(const SimulationResult& result);

/// reactions.csv: a row per state, the resultant force of each [[fix]], [[move]] and [[obstacle]]
/// on the body.
std::string reactions_csv(const SimulationResult& result);

/// The file of a state beside it: "state_0012.vtu".
std::string state_file_name(std::size_t state);

}  // namespace palpate
