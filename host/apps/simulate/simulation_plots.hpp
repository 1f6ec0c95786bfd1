// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/simulate/run_simulation.hpp"

namespace palpate {

/// The plots of the page as HTML figures with inline SVG; empty text where there is nothing to
/// draw.
std::string force_figures(const SimulationResult& result);  ///< over time, and over displacement
std::string newton_figure(const SimulationResult& result);
std::string energy_figure(const SimulationResult& result);  ///< of a motion

}  // namespace palpate
