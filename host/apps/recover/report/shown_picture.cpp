// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/shown_picture.hpp"

#include <algorithm>
#include <cmath>

#include "host/page/packing.hpp"
#include "host/page/png.hpp"

namespace palpate {
namespace {

/// Roughly square, because browsers limit the sides of pictures.
Index tiles_per_row_of(const std::array<Index, 3>& size) {
    const double square = std::sqrt(double(size[2]) * size[1] / size[0]);
    return std::clamp<Index>(Index(std::lround(square)), 1, size[2]);
}

std::string mosaic_of(const GreyPicture& grey, Index tiles_per_row) {
    const auto [columns, rows, slices] = grey.size;
    const Index width = columns * tiles_per_row;
    const Index height = rows * ((slices + tiles_per_row - 1) / tiles_per_row);
    std::vector<std::uint8_t> pixels(std::size_t(width) * height, 0);
    for (Index k = 0; k < slices; ++k)
        for (Index j = 0; j < rows; ++j) {
            const auto row = grey.voxels.begin() + std::ptrdiff_t(grey.offset(0, j, k));
            const std::size_t y = std::size_t(k / tiles_per_row) * rows + j;
            std::copy_n(row, columns,
                        pixels.begin() +
                            std::ptrdiff_t(y * width + std::size_t(k % tiles_per_row) * columns));
        }
    return to_base64(png_of(width, height, pixels));
}

}  // namespace

ShownPicture shown_picture(const Image<float>& image, const LabelVolumes& volumes,
                           const RigidTransform& to_image, const GreyWindow& window,
                           std::size_t max_bytes) {
    constexpr double expected_bytes_per_voxel = 0.7;  // of noisy images; fewer of smooth ones
    double max_voxels = double(max_bytes) / expected_bytes_per_voxel;
    for (;;) {
        ShownPicture picture;
        picture.grey = grey_picture(image, volumes, to_image, window, std::size_t(max_voxels));
        if (picture.empty()) return picture;
        picture.tiles_per_row = tiles_per_row_of(picture.grey.size);
        picture.mosaic = mosaic_of(picture.grey, picture.tiles_per_row);
        const double voxels = double(picture.grey.voxels.size());
        if (picture.mosaic.size() <= max_bytes || voxels <= 8) return picture;
        max_voxels = 0.97 * voxels * double(max_bytes) / double(picture.mosaic.size());
    }
}

ShownPictures shown_pictures(const GreyImages& images, const RecoveryResult& result,
                             const LabelVolumes& volumes) {
    ShownPictures pictures;
    if (volumes.empty()) return pictures;
    const RigidTransform back = result.alignment.reference_to_target.inverse(), same;
    GreyWindow reference, target;
    if (images.reference) reference = grey_window(*images.reference, volumes, back);
    if (images.target) target = grey_window(*images.target, volumes, same);
    if (images.reference && images.target) share_window(reference, target);
    if (images.reference)
        pictures.reference = shown_picture(*images.reference, volumes, back, reference);
    if (images.target) pictures.target = shown_picture(*images.target, volumes, same, target);
    return pictures;
}

}  // namespace palpate
