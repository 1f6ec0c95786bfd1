// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/simulate/simulation_settings.hpp"

namespace palpate {

/// The tables of a model file that read_loads takes.
inline constexpr std::array<std::string_view, 6> load_keys{"fix",      "move",     "force",
                                                           "pressure", "traction", "obstacle"};

/// Reads [[fix]], [[move]], [[force]], [[pressure]], [[traction]] and [[obstacle]] of `document`
/// into `settings`, whose history is there already. Throws Error(invalid_argument).
void read_loads(const SettingsTable& document, SimulationSettings& settings);

}  // namespace palpate
