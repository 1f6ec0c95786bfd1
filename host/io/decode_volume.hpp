// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/io/preflight.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// What one number of a file becomes; `position` counts numbers from 0. Throws
/// Error(input_unusable), without the file's name, for a number that cannot be used.
template <typename Value>
using Converted = Value (*)(double number, std::size_t position);

template <typename Value>
struct DecodedVolume {
    ImageGrid grid;
    std::vector<Value> values;  ///< [num_voxels * components], those of one voxel side by side
};

/// Decodes a checked volume by ITK in a child process with memory and time limits. `path` is for
/// messages; `progress` is only asked whether to cancel. For Value = std::uint16_t and float.
/// Throws Error(input_unreadable), Error(input_unusable) naming the file and what is wrong.
template <typename Value>
DecodedVolume<Value> decode_volume(const std::filesystem::path& path, CheckedVolume checked,
                                   Converted<Value> converted, const ProgressSink& progress = {});

}  // namespace palpate
