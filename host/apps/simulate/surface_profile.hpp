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

/// The height y(x) of these nodes in a state, deformed, up to where the surface overhangs.
///   farthest_mm   x up to which it is read: throws Error(solve_failed) if it overhangs before
///   rise_mm       [nodes] by which they are higher than in the model; empty: not at all
SmoothCurve surface_profile(const SimulationResult& simulation, const std::vector<Index>& nodes,
                            std::size_t state, double farthest_mm,
                            const std::vector<double>& rise_mm = {});

}  // namespace palpate
