// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/report/grey_picture.hpp"

namespace palpate {

/// What the text of one image may take in the page. Outlines for it and static slices, in which it
/// lies a second time, come to it: 1.2 MB for one image, 2.3 MB for both.
inline constexpr std::size_t picture_budget_bytes = 1'000'000;

/// A grey picture and its text for the page.
struct ShownPicture {
    GreyPicture grey;
    /// Base64 of a PNG file: the slices along the third axis as tiles, row by row, from the upper
    /// left; each with index 0 to the right and index 1 downwards.
    std::string mosaic;
    Index tiles_per_row = 1;

    bool empty() const { return grey.empty(); }
};

/// The images that were given and that show something of the slices.
struct ShownPictures {
    ShownPicture reference, target;

    bool empty() const { return reference.empty() && target.empty(); }
};

/// The finest picture whose mosaic takes at most `max_bytes`. Arguments as of `grey_picture`.
ShownPicture shown_picture(const Image<float>& image, const LabelVolumes& volumes,
                           const RigidTransform& to_image, const GreyWindow& window,
                           std::size_t max_bytes = picture_budget_bytes);

/// Both images in the frame of the slices, which is the target's: the reference image is carried
/// there by the rigid alignment.
ShownPictures shown_pictures(const GreyImages& images, const RecoveryResult& result,
                             const LabelVolumes& volumes);

}  // namespace palpate
