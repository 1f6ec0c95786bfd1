// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/apps/phantom/organ_shape.hpp"
#include "host/io/label_image.hpp"

namespace palpate {

/// The organs of the pelvis phantom in the order of its settings: region number = 2 + position.
enum PelvisOrgan { prostate, bladder, rectum, bone_left, bone_right, num_pelvis_organs };

/// What kind of bodies the phantoms are.
enum class AnatomyFamily {
    usual,     ///< as `make_anatomy` says
    round,     ///< prostate and bladder are about balls
    flat,      ///< prostate half as deep, bladder nearly empty
    touching,  ///< bladder and rectum lie on the prostate
    cut,       ///< the image ends within bladder and rectum
    drawn,     ///< one of these but `usual`, at random
};
/// Throws Error(invalid_argument) naming the families.
AnatomyFamily anatomy_family_of(const std::string& name);
std::string name_of(AnatomyFamily family);
/// Drawn for a seed, if that is what `family` says.
AnatomyFamily drawn_for(AnatomyFamily family, unsigned seed);

/// Implicit shapes (LPS mm: x left, y posterior, z superior) and the box of tissue round them.
struct PelvisAnatomy {
    std::array<OrganShape, num_pelvis_organs> organs;
    Vec3 box_corner = Vec3::Zero();  ///< lowest corner, mm
    Vec3 box_size = Vec3::Zero();    ///< mm
    /// What the images show of the box: all of it, but for `AnatomyFamily::cut`.
    Vec3 image_corner = Vec3::Zero(), image_size = Vec3::Zero();
};

/// An anatomy that varies with the seed: prostate of 30 to 65 cm^3 at the origin, bladder above and
/// in front and rectum behind it, dented by it at gaps of 3.2 to 6 mm, bones 11 to 15 mm to its
/// sides, no two organs closer than 2 mm, at least 20 mm of tissue to the sides of the box. The box
/// holds whole voxels of `spacing` (mm); it is the same for all spacings that divide 6 mm.
PelvisAnatomy make_anatomy(unsigned seed, const Vec3& spacing,
                           AnatomyFamily family = AnatomyFamily::usual);

/// The whole number of voxels of about `spacing` (exact if it is the anatomy's) that fill the box.
ImageGrid grid_of_box(const PelvisAnatomy& anatomy, const Vec3& spacing);
/// The same of what the images show.
ImageGrid grid_of_image(const PelvisAnatomy& anatomy, const Vec3& spacing);

/// Region of the shape that holds each voxel centre; background elsewhere.
RegionImage fill_shapes(const PelvisAnatomy& anatomy, const ImageGrid& grid);

}  // namespace palpate
