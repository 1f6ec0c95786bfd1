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

/// Distance maps of the organs that are matched (every organ that is not fixed), settings order.
std::vector<DistanceMap> maps_of_matched(const LabelField& field, const Settings& settings);
/// The same of the fixed organs.
std::vector<DistanceMap> maps_of_fixed(const LabelField& field, const Settings& settings);

}  // namespace palpate
