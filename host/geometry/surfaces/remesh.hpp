// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "host/geometry/surfaces/interfaces.hpp"
#include "host/geometry/surfaces/surface_complex.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// Wanted edge length (mm) at a vertex of the complex.
using EdgeLengthAt = std::function<double(const SurfaceComplex&, Index vertex)>;

/// Pulls the staircase of a lattice onto the smooth interfaces: alternately evens out vertices
/// along their surface or curve and steps to the interface, never further than `reach_mm` (per
/// axis, mm) from the lattice corner where the vertex began, so that sheets cannot pass each other.
void relax_staircase(SurfaceComplex& complex, const Interfaces& interfaces, const Vec3& reach_mm,
                     int rounds);

/// Makes triangles of the wanted edge length: splits long edges, collapses short ones, flips edges
/// for better angles, then moves vertices along their surface and onto the interfaces. Regions keep
/// their topology (link condition of Dey et al. 1999 on faces and on feature curves), feature
/// curves collapse only along themselves, no face turns over. `progress` is only asked whether to
/// cancel.
void remesh(SurfaceComplex& complex, const Interfaces& interfaces, const EdgeLengthAt& edge_length,
            int rounds, const ProgressSink& progress = {});

/// Collapses the edges that stayed far too short, flips, and opens wedges between faces that are
/// too sharp for tetrahedra.
void polish(SurfaceComplex& complex, const Interfaces& interfaces, const EdgeLengthAt& edge_length);

/// One round of moving vertices, guarded so that no face turns over or degenerates: `spread` of the
/// way to the middle of their neighbours along surface or curve (0: not at all), then onto the
/// interfaces.
void settle(SurfaceComplex& complex, const Interfaces& interfaces, double spread);

/// Moves one vertex to the middle of its neighbours, unguarded; box vertices stay on their planes.
void even_out(SurfaceComplex& complex, Index vertex);

}  // namespace palpate
