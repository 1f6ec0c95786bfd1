// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <string>

#include "host/io/decode_volume.hpp"
#include "host/io/volume_files.hpp"

namespace palpate {
namespace {

float finite_from(double number, std::size_t position) {
    if (!(std::abs(number) <= std::numeric_limits<float>::max())) detail::not_finite(position);
    return static_cast<float>(number);
}

CheckedVolume checked_volume(const std::filesystem::path& path, Voxels voxels,
                             std::vector<std::string>* warnings) {
    CheckedVolume checked = preflight(path, voxels);
    if (warnings) *warnings = checked.warnings;
    return checked;
}

}  // namespace

Image<float> read_scalar_image(const std::filesystem::path& path,
                               std::vector<std::string>* warnings, const ProgressSink& progress) {
    auto volume = decode_volume<float>(path, checked_volume(path, Voxels::used, warnings),
                                       finite_from, progress);
    return {volume.grid, std::move(volume.values)};
}

ImageGrid read_image_grid(const std::filesystem::path& path, std::vector<std::string>* warnings) {
    const auto as_it_is = [](double, std::size_t) { return 0.0f; };
    return decode_volume<float>(path, checked_volume(path, Voxels::unused, warnings), as_it_is)
        .grid;
}

Image<Vec3> read_vector_image(const std::filesystem::path& path) {
    const auto volume = decode_volume<float>(path, preflight_vectors(path), finite_from);
    Image<Vec3> image{volume.grid, {}};
    image.voxels.reserve(image.grid.num_voxels());
    for (std::size_t n = 0; n + 2 < volume.values.size(); n += 3) {
        image.voxels.emplace_back(volume.values[n], volume.values[n + 1], volume.values[n + 2]);
    }
    return image;
}

}  // namespace palpate
