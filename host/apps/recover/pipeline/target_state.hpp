// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/recover/modelling/alignment.hpp"
#include "host/apps/recover/pipeline/reference_state.hpp"
#include "host/geometry/surfaces/surface.hpp"
#include "host/geometry/surfaces/target_shape.hpp"

namespace palpate {

/// The part of an organ's surface that a target without labels shows.
struct ShownSurface {
    std::string kind = "none";                 ///< "surface", "points", or "none": not given
    std::shared_ptr<const TargetShape> shape;  ///< null if not given
    Surface picture;                           ///< for the report; small marks in place of points
};

/// A target, brought into the reference's frame: a label volume, or surfaces and points.
struct TargetState {
    std::string name;  ///< for messages and the report
    AlignmentResult alignment;
    std::optional<LabelledState> labels;  ///< in its own frame
    std::vector<ShownSurface> shown;      ///< without labels: of the matched organs, settings order
    double noise_mm = 0;                  ///< without labels: of a point about the organ's surface
};

/// Throws Error(input_unusable) if an organ does not overlap between the two.
TargetState align_target(LabelledState target, const ReferenceState& reference,
                         const RecoverOptions& options, const ProgressSink& progress);

}  // namespace palpate
