// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/simulate/run_simulation.hpp"

namespace palpate {

/// Pictures of the deformed body with inline SVG: displacement and von Mises stress, on its surface
/// where the viewer of `body_view` cannot be (of class `still`), of a solid in the section through
/// its middle, too.
std::string body_figures(const SimulationResult& result);

}  // namespace palpate
