// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/simulate/run_simulation.hpp"

namespace palpate {

/// Pictures of the deformed body as HTML figures with inline SVG: displacement and von Mises
/// stress, of a solid on its surface and in the section through its middle.
std::string body_figures(const SimulationResult& result);

}  // namespace palpate
