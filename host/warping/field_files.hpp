// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "host/warping/displacement_field.hpp"

// The displacement fields of a result folder; docs/transforms.md.
namespace palpate {

/// One sense of a deformation: which points it takes, where it takes them, in which files.
struct FieldFile {
    const char* points_from;  ///< "reference" or "target"; the field lies on the grid of that image
    const char* points_to;
    const char* field;  ///< NIfTI of five dimensions, intent 1007
    /// ITK transform. Its name says, as is usual for these, which image it resamples onto the grid
    /// of which: the other way round than the points go.
    const char* transform;
};

inline constexpr FieldFile forward_field{"reference", "target", "displacement.nii.gz",
                                         "from-target_to-reference_mode-image_xfm.h5"};
inline constexpr FieldFile backward_field{"target", "reference", "displacement_inverse.nii.gz",
                                          "from-reference_to-target_mode-image_xfm.h5"};

/// Write one file of a sense into `folder`. Throw Error(output_failed).
void write_field_image(const std::filesystem::path& folder, const FieldFile& names,
                       const Image<Vec3>& displacement);
void write_field_transform(const std::filesystem::path& folder, const FieldFile& names,
                           const Image<Vec3>& displacement);

enum class Sense { reference_to_target, target_to_reference };

/// The map of points that `source` holds: a result folder, or one displacement field (.nii, .nii.gz
/// of intent 1007, .h5), which counts as reference to target and is inverted for the other sense.
/// A folder without the field of a sense gives the inverse of the other.
/// Throws Error(input_unreadable), Error(input_unusable).
PointMap read_point_map(const std::filesystem::path& source, Sense sense);

}  // namespace palpate
