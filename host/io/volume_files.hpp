// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/io/label_image.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// Reads a 3D label volume (NIfTI .nii/.nii.gz, NRRD .nrrd/.nhdr, MetaImage .mha/.mhd). The file is
/// checked first (whole gzip stream with CRC and size, header fields finite, units, enough bytes,
/// detached data inside the header's folder), then decoded by ITK in a child process with memory
/// and time limits. Left-handed grids keep their direction (det = -1). Values must be whole
/// numbers in 0..65535.
/// Throws Error(input_unreadable) naming the file and what is wrong, Error(input_unusable) for a
/// readable file that is not a 3D label volume. `progress` is only asked whether to cancel.
/// `warnings` receives sentences about what is odd but was accepted.
LabelImage read_label_image(const std::filesystem::path& path, const ProgressSink& progress = {},
                            std::vector<std::string>* warnings = nullptr);

/// Reads any 3D volume of one number per voxel in the same way, as single precision.
Image<float> read_scalar_image(const std::filesystem::path& path,
                               std::vector<std::string>* warnings = nullptr,
                               const ProgressSink& progress = {});

/// The grid of such a volume, whatever its numbers are.
ImageGrid read_image_grid(const std::filesystem::path& path,
                          std::vector<std::string>* warnings = nullptr);

/// Writes .nii, .nii.gz, .nrrd or .mha (single precision, compressed), all or nothing. Throws as
/// `write_label_image`.
void write_scalar_image(const std::filesystem::path& path, const Image<float>& image);

/// Writes .nii, .nii.gz, .nrrd or .mha (8 bits per voxel if the labels allow, else 16, compressed),
/// all or nothing. Throws Error(output_failed), Error(unsupported) for another ending.
void write_label_image(const std::filesystem::path& path, const LabelImage& image);

/// Writes a displacement field as a 5-D NIfTI with intent 1007 (vector), .nii or .nii.gz, all or
/// nothing. Components are LPS mm in memory and in ITK's convention on disk, [num_voxels], single
/// precision, rounded to 1/128 mm (displacement_steps.hpp; the field `descrip` says so).
/// Throws Error(output_failed), Error(unsupported) for another ending.
void write_vector_image(const std::filesystem::path& path, const Image<Vec3>& image);

/// Reads what `write_vector_image` writes. Throws Error(input_unreadable), and
/// Error(input_unusable) for other intents (1006) and shapes (4-D): programs differ in what their
/// axes mean.
Image<Vec3> read_vector_image(const std::filesystem::path& path);

/// The same field, rounded in the same way, as an ITK transform of points, x -> x + u(x): ITK's
/// HDF5 format (.h5, .hdf5), single precision, compressed (by ITK, some seven times as slowly as
/// NIfTI), all or nothing. Throws Error(output_failed), Error(unsupported).
void write_displacement_transform(const std::filesystem::path& path, const Image<Vec3>& image);

/// Reads one displacement field of three dimensions, in a child process. Throws
/// Error(input_unreadable), Error(input_unusable): another or more than one transform.
Image<Vec3> read_displacement_transform(const std::filesystem::path& path);

/// By the ending of its name, in any case.
bool is_transform_file(const std::filesystem::path& path);

/// Reads a rigid ITK transform (.tfm, .txt, .h5): a translation, Euler3D, VersorRigid3D, or affine
/// whose matrix is a rotation. Sense: it takes points of the reference to points of the target
/// (the resampling sense with the reference as fixed image), LPS mm.
/// Throws Error(input_unreadable) or Error(input_unusable) if it is not rigid.
RigidTransform read_rigid_transform(const std::filesystem::path& path);
void write_rigid_transform(const std::filesystem::path& path, const RigidTransform& transform);

}  // namespace palpate
