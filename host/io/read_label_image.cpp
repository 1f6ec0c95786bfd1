// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "host/io/decode_volume.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::uint16_t label_from(double number, std::size_t position) {
    const double nearest = std::round(number);
    if (!(std::abs(number - nearest) <= 1e-3) || nearest < 0 || nearest > 65535) {
        throw Error(ErrorCode::input_unusable, "voxel " + std::to_string(position) +
                                                   " has the value " + std::to_string(number) +
                                                   "; labels are whole numbers from 0 to 65535");
    }
    return static_cast<std::uint16_t>(nearest);
}

}  // namespace

LabelImage read_label_image(const std::filesystem::path& path, const ProgressSink& progress,
                            std::vector<std::string>* warnings) {
    CheckedVolume checked = preflight(path);
    if (warnings) *warnings = checked.warnings;
    auto volume = decode_volume<std::uint16_t>(path, std::move(checked), label_from, progress);
    return {volume.grid, std::move(volume.values)};
}

}  // namespace palpate
