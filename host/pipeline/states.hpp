// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/imaging/label_field.hpp"
#include "host/modelling/alignment.hpp"
#include "host/pipeline/recover.hpp"
#include "host/surfaces/surface.hpp"
#include "host/surfaces/target_shape.hpp"

namespace palpate {

/// One segmentation, ready to be measured against.
struct LabelledState {
    std::string name;  ///< for messages and the report
    RegionImage regions;
    LabelField field;
    std::vector<std::string> warnings = {};  ///< sentences
};

LabelledState make_state(const Segmentation& segmentation, const Settings& settings);

/// The reference before it is meshed.
struct ReferenceState {
    LabelledState state;
    double edge_length_mm = 0;  ///< on organ surfaces, for the wanted number of nodes
    RegionSurface surface;
    std::vector<std::vector<Vec3>> fixed_points;  ///< of the fixed organs' surfaces, without caps
};

ReferenceState make_reference(LabelledState state, const RecoverOptions& options,
                              const ProgressSink& progress);

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

/// Distance maps of the organs that are matched (every organ that is not fixed), settings order.
std::vector<DistanceMap> maps_of_matched(const LabelField& field, const Settings& settings);

}  // namespace palpate
