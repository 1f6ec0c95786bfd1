// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/regions.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t fewest_voxels = 8;

std::map<std::uint16_t, Index> region_of_labels(const Settings& settings) {
    std::map<std::uint16_t, Index> regions;
    if (settings.background && settings.background->label) {
        regions[static_cast<std::uint16_t>(*settings.background->label)] = background_region;
    }
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        regions[static_cast<std::uint16_t>(settings.organs[k].label)] =
            first_organ_region + static_cast<Index>(k);
    }
    return regions;
}

std::string labels_in(const LabelImage& image) {
    const std::set<std::uint16_t> labels(image.voxels.begin(), image.voxels.end());
    std::string text;
    for (const auto label : labels) {
        if (text.size() > 60) return text + ", ...";
        text += fmt::format("{}{}", text.empty() ? "" : ", ", label);
    }
    return text;
}

void check_voxel_counts(const RegionImage& regions, const LabelImage& image,
                        const Settings& settings, const std::string& image_name) {
    std::vector<std::size_t> count(256, 0);
    for (const auto region : regions.voxels) ++count[region];
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        const auto voxels = count[first_organ_region + k];
        if (voxels >= fewest_voxels) continue;
        const auto& organ = settings.organs[k];
        throw Error(
            ErrorCode::input_unusable,
            voxels == 0
                ? fmt::format("{}: organ '{}' is empty: no voxel has label {} (labels present: "
                              "{}); correct the label in the settings or the segmentation",
                              image_name, organ.name, organ.label, labels_in(image))
                : fmt::format("{}: organ '{}' (label {}) has only {} voxels, at least {} are "
                              "needed; correct the segmentation",
                              image_name, organ.name, organ.label, voxels, fewest_voxels));
    }
    if (settings.background && settings.background->label && count[background_region] == 0) {
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{}: no voxel has the background label {} (labels present: {})",
                                image_name, *settings.background->label, labels_in(image)));
    }
}

}  // namespace

RegionImage to_regions(const LabelImage& image, const Settings& settings,
                       const std::string& image_name) {
    const auto regions_of = region_of_labels(settings);
    const bool rest_is_background = settings.background && !settings.background->label;
    std::vector<std::uint8_t> table(
        65536, static_cast<std::uint8_t>(rest_is_background ? background_region : outside_region));
    for (const auto& [label, region] : regions_of) table[label] = static_cast<std::uint8_t>(region);

    RegionImage regions{image.grid, std::vector<std::uint8_t>(image.voxels.size())};
    std::transform(image.voxels.begin(), image.voxels.end(), regions.voxels.begin(),
                   [&](std::uint16_t label) { return table[label]; });
    check_voxel_counts(regions, image, settings, image_name);
    return regions;
}

Index label_of_region(const Settings& settings, Index region) {
    if (region >= first_organ_region) return settings.organs[region - first_organ_region].label;
    const bool has_label = region == background_region && settings.background &&
                           settings.background->label.has_value();
    return has_label ? *settings.background->label : 0;
}

std::string name_of_region(const Settings& settings, Index region) {
    if (region == outside_region) return "outside";
    if (region == background_region) return "background";
    return settings.organs[region - first_organ_region].name;
}

std::vector<Index> hollow_regions(const Settings& settings) {
    std::vector<Index> hollow;
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (settings.organs[k].hollow) hollow.push_back(first_organ_region + static_cast<Index>(k));
    }
    return hollow;
}

std::vector<std::string> thin_organs(const RegionImage& regions, const Settings& settings) {
    const auto& size = regions.grid.size;
    std::vector<std::uint8_t> has_inside(256, 0);
    for (Index k = 1; k + 1 < size[2]; ++k)
        for (Index j = 1; j + 1 < size[1]; ++j)
            for (Index i = 1; i + 1 < size[0]; ++i) {
                const auto here = regions.at(i, j, k);
                if (here < first_organ_region || has_inside[here]) continue;
                has_inside[here] =
                    regions.at(i - 1, j, k) == here && regions.at(i + 1, j, k) == here &&
                    regions.at(i, j - 1, k) == here && regions.at(i, j + 1, k) == here &&
                    regions.at(i, j, k - 1) == here && regions.at(i, j, k + 1) == here;
            }
    std::vector<std::string> sentences;
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (has_inside[first_organ_region + k]) continue;
        sentences.push_back(fmt::format(
            "{} is nowhere three voxels thick, so its shape rests on few voxels; segment it on a "
            "finer grid before its values are used.",
            settings.organs[k].name));
    }
    return sentences;
}

}  // namespace palpate
