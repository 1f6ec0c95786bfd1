// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/apps/recover/report/label_volumes.hpp"

namespace palpate {

/// Images of the patient to be shown under the outlines, each in the frame of its own
/// segmentation; null: none. Only for the report, which holds what they show (faces, too).
struct GreyImages {
    const Image<float>* reference = nullptr;
    const Image<float>* target = nullptr;

    bool empty() const { return !reference && !target; }
};

/// The numbers that are shown black and white.
struct GreyWindow {
    double black = 0, white = 1;

    std::uint8_t grey(double number) const;
};

/// A window to judge outlines by. Of Hounsfield units (recognised by whole numbers, air and soft
/// tissue) what radiologists use: lung where a quarter of `shown` is aerated, else soft tissue. Of
/// everything else the numbers between the first and the 98th hundredth of `shown`, so that bright
/// fluid and vessels count little. `shown` holds NaN where the image says nothing.
GreyWindow grey_window(const Image<float>& image, const std::vector<float>& shown);

/// The same for what the box of the label volumes shows of an image; `to_image` as below.
GreyWindow grey_window(const Image<float>& image, const LabelVolumes& volumes,
                       const RigidTransform& to_image);

/// One window for two images that are much alike, so that they can be compared by exchanging one
/// for the other; else each keeps its own.
void share_window(GreyWindow& a, GreyWindow& b);

/// An image as the report shows it: 8 bits, cut into voxels over exactly the box of the label
/// volumes, along the same axes, but with lengths of its own.
struct GreyPicture {
    std::array<Index, 3> size{0, 0, 0};
    GreyWindow window;
    std::vector<std::uint8_t> voxels;  ///< index 0 fastest; black where the image says nothing

    bool empty() const { return voxels.empty(); }
    std::size_t offset(Index i, Index j, Index k) const {
        return std::size_t(i) + std::size_t(size[0]) * (std::size_t(j) + std::size_t(size[1]) * k);
    }
};

/// Resamples linearly, and by means over voxels where it makes them larger.
///   to_image    takes points of the slices to points of the image, LPS mm
///   max_voxels  the finest voxels grow until no more are left than this, so that thick slices stay
/// Empty if the image says nothing about the box.
GreyPicture grey_picture(const Image<float>& image, const LabelVolumes& volumes,
                         const RigidTransform& to_image, const GreyWindow& window,
                         std::size_t max_voxels);

}  // namespace palpate
