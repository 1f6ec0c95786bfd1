// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "host/io/image.hpp"

namespace palpate {

/// A segmentation as it is in the file: one integer label per voxel.
using LabelImage = Image<std::uint16_t>;

/// Region numbers inside palpate: 0 = outside (never meshed), 1 = background tissue, 2 + k = the
/// organ k of the settings. Label images from files are turned into region images once, at the
/// border; meshes, surfaces and models use region numbers only.
constexpr Index outside_region = 0;
constexpr Index background_region = 1;
constexpr Index first_organ_region = 2;

using RegionImage = Image<std::uint8_t>;

}  // namespace palpate
