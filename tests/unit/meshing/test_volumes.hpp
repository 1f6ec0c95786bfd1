// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/geometry/fields/label_field.hpp"

namespace palpate::testing {

struct Ball {
    Vec3 centre = Vec3::Zero();  ///< mm from the low corner of the box, along the image axes
    double radius = 0;
    Index region = 0;
};

/// A region image of background with balls in it, later ones over earlier ones. Box of `size_mm` a
/// side.
RegionImage ball_image(double size_mm, double voxel_mm, const std::vector<Ball>& balls,
                       const Mat3& direction = Mat3::Identity());

/// The balls of `sphere_pelvis`: prostate 2 with zone 5, bladder 3, rectum 4.
std::vector<Ball> pelvis_balls();

/// A small image of background alone, for meshers that do not look at it.
RegionImage plain_image();

}  // namespace palpate::testing
