// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/warping/field_files.hpp"

#include <fmt/format.h>

#include "host/imaging/io.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

Image<Vec3> read_field(const fs::path& path) {
    return is_transform_file(path) ? read_displacement_transform(path) : read_vector_image(path);
}

}  // namespace

void write_field_image(const fs::path& folder, const FieldFile& names,
                       const Image<Vec3>& displacement) {
    write_vector_image(folder / names.field, displacement);
}

void write_field_transform(const fs::path& folder, const FieldFile& names,
                           const Image<Vec3>& displacement) {
    write_displacement_transform(folder / names.transform, displacement);
}

PointMap read_point_map(const fs::path& source, Sense sense) {
    const bool forward = sense == Sense::reference_to_target;
    std::error_code error;
    if (!fs::is_directory(source, error)) return {read_field(source), !forward};
    const fs::path direct = source / (forward ? forward_field : backward_field).field;
    if (fs::exists(direct, error)) return {read_field(direct), false};
    const fs::path other = source / (forward ? backward_field : forward_field).field;
    if (fs::exists(other, error)) return {read_field(other), true};
    throw Error(ErrorCode::input_unreadable,
                fmt::format("{} holds no {}; give a result folder of `palpate recover` or a "
                            "displacement field (.nii.gz, .h5)",
                            source.string(), forward_field.field));
}

}  // namespace palpate
