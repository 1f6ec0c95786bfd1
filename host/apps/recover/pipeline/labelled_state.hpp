// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/recover/modelling/settings.hpp"
#include "host/apps/recover/pipeline/segmentation.hpp"
#include "host/geometry/fields/label_field.hpp"
#include "host/geometry/surfaces/distance_map.hpp"

namespace palpate {

/// One segmentation, ready to be measured against.
struct LabelledState {
    std::string name;  ///< for messages and the report
    RegionImage regions;
    LabelField field;
    std::vector<std::string> warnings = {};  ///< sentences
};

LabelledState make_state(const Segmentation& segmentation, const Settings& settings);

/// Whether its surface is compared with the target's: every organ that is not fixed.
bool is_matched(const OrganSettings& organ);
bool is_fixed(const OrganSettings& organ);

/// How far maps reach beyond an organ, mm: of what measures its own nodes, and what others.
constexpr double own_margin_mm = 5;
constexpr double target_margin_mm = 20;

/// Distance maps of the organs that are matched (every organ that is not fixed), settings order;
/// those of a target are asked farther out than the nodes of a reference lie from its own surface.
std::vector<DistanceMap> maps_of_matched(const LabelField& field, const Settings& settings,
                                         double margin_mm);
/// The same of the fixed organs.
std::vector<DistanceMap> maps_of_fixed(const LabelField& field, const Settings& settings,
                                       double margin_mm);

}  // namespace palpate
