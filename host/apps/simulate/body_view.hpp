// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/simulate/run_simulation.hpp"
#include "host/page/surface_view.hpp"

namespace palpate {

/// Each region's surface (of a plane mesh its elements; about an axis with the mirror image) and
/// the obstacles, in the states of the result or, of many, in some of them, with all that the
/// result has per element as means at the nodes of the region.
SurfaceView body_view(const SimulationResult& result);

}  // namespace palpate
