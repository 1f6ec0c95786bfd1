// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/simulate/run_simulation.hpp"

namespace palpate {

/// simulation.json: the settings with every default filled in, Newton's record of each step, the
/// resultants and messages. UTF-8, keys in a fixed order, units in the names, numbers that are not
/// finite are null. Holds no path and no file name.
std::string simulation_json(const SimulationResult& result);

/// reactions.csv: a row per state, the resultant force of each [[fix]], [[move]] and [[obstacle]]
/// on the body.
std::string reactions_csv(const SimulationResult& result);

/// The file of a state beside it: "state_0012.vtu".
std::string state_file_name(std::size_t state);

}  // namespace palpate
