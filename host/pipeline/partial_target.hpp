// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/pipeline/states.hpp"

namespace palpate {

/// What can be told from the settings alone. Throws Error(invalid_argument): no organ given; one
/// that is unknown, fixed or given twice; an alignment or a search that needs a label volume.
void check_partial_target(const PartialTarget& target, const RecoverOptions& options);

/// Surfaces and points turned outward in the reference frame. `target` must have passed
/// `check_partial_target`. Throws Error(input_unusable) naming shape and organ if it is far from
/// the organ or far smaller, and what reading the transform throws.
TargetState place_target(const PartialTarget& target, const ReferenceState& reference,
                         const RecoverOptions& options);

}  // namespace palpate
