// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/modelling/build_model.hpp"

namespace palpate {

/// A sheet z = 0 of `side` x `side` nodes, node i + side * j at (i, j) times `spacing_mm`, as the
/// surface of one organ. None is driven or observed yet.
inline RecoveryModel flat_organ(Index side, double spacing_mm) {
    RecoveryModel recovery;
    ObservedSurface organ;
    for (Index node = 0; node < side * side; ++node) {
        const Index i = node % side, j = node / side;
        recovery.model.mesh.nodes.emplace_back(spacing_mm * i, spacing_mm * j, 0);
        organ.surface.vertices.push_back(recovery.model.mesh.nodes.back());
        organ.node_of.push_back(node);
        if (i == 0 || j == 0) continue;
        organ.surface.triangles.push_back({node, node - 1, node - side});
        organ.surface.triangles.push_back({node - 1, node - side - 1, node - side});
    }
    recovery.surfaces.push_back(organ);
    return recovery;
}

}  // namespace palpate
