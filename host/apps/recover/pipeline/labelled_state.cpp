// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/labelled_state.hpp"

#include <future>
#include <utility>

#include "host/apps/recover/modelling/regions.hpp"

namespace palpate {
namespace {

/// Distance maps of the organs with the given role(s), in settings order.
template <typename Wanted>
std::vector<DistanceMap> maps_of(const LabelField& field, const Settings& settings,
                                 double margin_mm, const Wanted& wanted) {
    std::vector<std::future<DistanceMap>> maps;
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (!wanted(settings.organs[k])) continue;
        const Index region = first_organ_region + static_cast<Index>(k);
        maps.push_back(std::async(std::launch::async, [&field, region, margin_mm] {
            return DistanceMap(field, region, margin_mm);
        }));
    }
    std::vector<DistanceMap> done;
    for (auto& map : maps) done.push_back(map.get());
    return done;
}

}  // namespace

bool is_matched(const OrganSettings& organ) { return organ.role != Role::fixed; }
bool is_fixed(const OrganSettings& organ) { return organ.role == Role::fixed; }

LabelledState make_state(const Segmentation& segmentation, const Settings& settings) {
    RegionImage regions = to_regions(segmentation.labels, settings, segmentation.name);
    LabelField field(regions, settings.num_regions());
    std::vector<std::string> warnings = segmentation.warnings;
    for (std::string& warning : thin_organs(regions, settings))
        warnings.push_back(std::move(warning));
    return {segmentation.name, std::move(regions), std::move(field), std::move(warnings)};
}

std::vector<DistanceMap> maps_of_matched(const LabelField& field, const Settings& settings,
                                         double margin_mm) {
    return maps_of(field, settings, margin_mm, is_matched);
}

std::vector<DistanceMap> maps_of_fixed(const LabelField& field, const Settings& settings,
                                       double margin_mm) {
    return maps_of(field, settings, margin_mm, is_fixed);
}

}  // namespace palpate
