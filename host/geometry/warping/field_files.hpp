// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "host/geometry/warping/displacement_field.hpp"

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

/// Which files of each sense a result folder gets.
enum class FieldChoice {
    none,
    one,  ///< the NIfTI image: more programs read it, 3D Slicer and ITK among them
    all,  ///< the ITK transform, too
};

/// "none", "one" or "all"; throws Error(invalid_argument) for another word.
FieldChoice field_choice_of(const std::string& name);

constexpr bool has_image(FieldChoice choice) { return choice != FieldChoice::none; }
constexpr bool has_transform(FieldChoice choice) { return choice == FieldChoice::all; }

/// Writes the chosen files of a sense into `folder`. Throws Error(output_failed).
void write_fields(const std::filesystem::path& folder, const FieldFile& names,
                  const Image<Vec3>& displacement, FieldChoice choice);

/// Writes one displacement field, .nii, .nii.gz, .h5 or .hdf5 by the ending of `path`, all or
/// nothing. Throws Error(output_failed), Error(unsupported) for another ending.
void write_field(const std::filesystem::path& path, const Image<Vec3>& displacement);

/// Whether `path` has such an ending.
bool is_field_file(const std::filesystem::path& path);

enum class Sense { reference_to_target, target_to_reference };

/// The map of points that `source` holds: a result folder, or one displacement field (.nii, .nii.gz
/// of intent 1007, .h5), which counts as reference to target and is inverted for the other sense.
/// Of a sense either of its files will do; a folder without both gives the inverse of the other
/// sense. Throws Error(input_unreadable), Error(input_unusable).
PointMap read_point_map(const std::filesystem::path& source, Sense sense);

/// The displacement of a sense as it was written into a result folder, or as one file holds it
/// (which counts as reference to target). Throws Error(input_unreadable) where only the inverse of
/// the other sense could be given, else as `read_point_map`.
Image<Vec3> read_written_field(const std::filesystem::path& source, Sense sense);

}  // namespace palpate
