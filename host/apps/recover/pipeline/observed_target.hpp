// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <memory>
#include <vector>

#include "host/apps/recover/observations/surface_observations.hpp"
#include "host/apps/recover/pipeline/target_state.hpp"

namespace palpate {

/// What the surface of each matched organ should come to lie on, in the reference frame, in
/// settings order (that of `RecoveryModel::surfaces`). Null: the target does not show it.
using TargetShapes = std::vector<std::shared_ptr<const TargetShape>>;
TargetShapes target_shapes(const TargetState& target, const Settings& settings);

/// The same in the background, from before the reference is meshed or the target before this one is
/// searched. `target` and `settings` must outlive the future.
std::future<TargetShapes> start_target_shapes(const TargetState& target, const Settings& settings);

/// Whether the target could show what came from a point of the reference, mm: a label volume ends
/// at its box. Where surfaces and points end is for their shapes to say.
bool in_field_of_view(const TargetState& target, const Vec3& point);

/// The contours' error of both images together over that of one. Points and surfaces that were
/// measured have noise of their own.
double contour_images(const TargetState& target);

/// The noise of distances between the reference and this target.
ObservationOptions observation_options(const Settings& settings, const LabelledState& reference,
                                       const TargetState& target);

}  // namespace palpate
