// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/simulate/run_simulation.hpp"

namespace palpate {

/// report.html: one file that needs nothing else and fetches nothing. The body can be turned and
/// deformed; without scripts or WebGL, and on paper, there are pictures of it. Every text from
/// outside is escaped.
std::string simulation_page(const SimulationResult& result);

}  // namespace palpate
