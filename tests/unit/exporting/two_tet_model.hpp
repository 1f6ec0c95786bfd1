// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/export/recovered_model.hpp"

namespace palpate::testing {

/// Two tetrahedra of two tissues; three nodes fixed, one free, one on a moving wall.
inline RecoveredModel two_tet_model() {
    RecoveredModel model;
    model.mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {1, 2, 3}};
    model.mesh.tets = {{0, 1, 2, 3}, {1, 4, 2, 3}};
    model.mesh.region = {0, 5};
    model.regions = {{"background", "background", 0, 10, 0.35, {0}},
                     {"prostate, peripheral zone", "prostate_peripheral_zone", 5, 60, 0.4, {1}}};
    model.held = {Held::fixed, Held::fixed, Held::fixed, Held::free, Held::driven};
    model.displacement.assign(5, Vec3::Zero());
    model.displacement[3] = Vec3(0.1, 0, 0);
    model.displacement[4] = Vec3(0.25, -0.5, 0.75);
    model.force.assign(5, Vec3::Zero());
    model.force[4] = Vec3(1500, -20, 3);
    model.version = "0.1.0";
    return model;
}

}  // namespace palpate::testing
