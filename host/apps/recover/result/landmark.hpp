// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/base/types.hpp"

namespace palpate {

/// The same anatomical point in both images, LPS mm.
struct Landmark {
    Vec3 reference = Vec3::Zero();
    Vec3 target = Vec3::Zero();
};

/// How far it lies from where it should: by the rigid alignment alone, and by the recovered motion.
/// Landmarks take no part in the search.
struct LandmarkResult {
    Landmark at;
    double error_mm_before = 0, error_mm_after = 0;
    bool is_inside = true;  ///< false: outside the field, which was continued from its border
};

}  // namespace palpate
