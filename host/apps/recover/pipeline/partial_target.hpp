// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "host/apps/recover/pipeline/target_state.hpp"
#include "host/geometry/surfaces/surface.hpp"

namespace palpate {

/// The surface of one organ, which may be open, or points on it, mm LPS.
struct OrganTarget {
    std::string organ;  ///< its name in the settings
    std::string name;   ///< for messages and the report
    std::variant<Surface, std::vector<Vec3>> shape;
};

/// A target of which no label volume exists. Organs that are not given, and what a shape does not
/// show of one, carry no data.
struct PartialTarget {
    std::vector<OrganTarget> organs;
    double noise_mm = 0.5;  ///< standard deviation of its points about the organs' surfaces
};

/// What can be told from the settings alone. Throws Error(invalid_argument): no organ given; one
/// that is unknown, fixed or given twice; an alignment or a search that needs a label volume.
void check_partial_target(const PartialTarget& target, const RecoverOptions& options);

/// Surfaces and points turned outward in the reference frame. `target` must have passed
/// `check_partial_target`. Throws Error(input_unusable) naming shape and organ if it is far from
/// the organ or far smaller, and what reading the transform throws.
TargetState place_target(const PartialTarget& target, const ReferenceState& reference,
                         const RecoverOptions& options);

}  // namespace palpate
