// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/modelling/settings.hpp"
#include "host/io/label_image.hpp"

namespace palpate {

/// File labels -> region numbers (label_image.hpp). With a background that names a label,
/// everything that is neither an organ nor that label is outside; with a background without label,
/// everything else is background; without a background, everything else is outside. Throws
/// Error(input_unusable) naming `image_name`, the organ and its label if an organ has no voxel or
/// too few (fewer than 8) to carry a surface.
RegionImage to_regions(const LabelImage& image, const Settings& settings,
                       const std::string& image_name);

/// The file label of a region: the organ's, the background's (0 if it has none), 0 for outside.
Index label_of_region(const Settings& settings, Index region);
std::string name_of_region(const Settings& settings, Index region);

/// Regions without elements: hollow organs.
std::vector<Index> hollow_regions(const Settings& settings);

/// A sentence for each organ that is nowhere three voxels thick: no voxel of it has six neighbours
/// of its own.
std::vector<std::string> thin_organs(const RegionImage& regions, const Settings& settings);

}  // namespace palpate
