// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/simulate/run_simulation.hpp"
#include "host/apps/simulate/smooth_curve.hpp"

namespace palpate {

/// Nodes of a surface of a plane or axisymmetric body, ascending along x at rest. Throws
/// Error(invalid_argument) as `selected_nodes` does.
std::vector<Index> nodes_along(const Selection& surface, const SimulationResult& simulation);

/// A deformed surface: its height y(x), and which x at rest it has what is now at x from.
struct SurfaceProfile {
    SmoothCurve height, rest_x;
};

/// Of these nodes in a state, up to where the surface overhangs.
///   farthest_mm   x up to which it is read: throws Error(solve_failed) if it overhangs before
SurfaceProfile surface_profile(const SimulationResult& simulation, const std::vector<Index>& nodes,
                               std::size_t state, double farthest_mm);

}  // namespace palpate
