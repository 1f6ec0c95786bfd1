// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/simulate/run_simulation.hpp"

namespace palpate {

/// report.html: one file that needs nothing else and fetches nothing, without scripts. Every text
/// from outside is escaped.
std::string simulation_page(const SimulationResult& result);

}  // namespace palpate
