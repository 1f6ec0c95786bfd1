// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/field_files.hpp"

#include <fmt/format.h>

#include <optional>

#include "host/io/preflight.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

Image<Vec3> read_field(const fs::path& path) {
    return is_transform_file(path) ? read_displacement_transform(path) : read_vector_image(path);
}

const FieldFile& names_of(Sense sense) {
    return sense == Sense::reference_to_target ? forward_field : backward_field;
}

/// The first of a sense's files that is there.
std::optional<fs::path> file_in(const fs::path& folder, Sense sense) {
    for (const char* name : {names_of(sense).field, names_of(sense).transform}) {
        std::error_code error;
        if (fs::exists(folder / name, error)) return folder / name;
    }
    return std::nullopt;
}

[[noreturn]] void no_field_in(const fs::path& folder) {
    std::error_code error;
    if (fs::exists(folder / "result.json", error))
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{} holds a result without displacement fields ({}); run `palpate "
                                "recover` again without --fields none",
                                folder.string(), forward_field.field));
    throw Error(ErrorCode::input_unreadable,
                fmt::format("{} holds no {}; give a result folder of `palpate recover` or a "
                            "displacement field (.nii.gz, .h5)",
                            folder.string(), forward_field.field));
}

}  // namespace

FieldChoice field_choice_of(const std::string& name) {
    if (name == "none") return FieldChoice::none;
    if (name == "one") return FieldChoice::one;
    if (name == "all") return FieldChoice::all;
    throw Error(ErrorCode::invalid_argument,
                fmt::format("'{}' does not say which displacement fields to write; use \"none\", "
                            "\"one\" or \"all\"",
                            name));
}

void write_fields(const fs::path& folder, const FieldFile& names, const Image<Vec3>& displacement,
                  FieldChoice choice) {
    if (has_image(choice)) write_field(folder / names.field, displacement);
    if (has_transform(choice)) write_field(folder / names.transform, displacement);
}

bool is_field_file(const fs::path& path) {
    return is_transform_file(path) || format_of(path) == VolumeFormat::nifti;
}

void write_field(const fs::path& path, const Image<Vec3>& displacement) {
    if (is_transform_file(path)) return write_displacement_transform(path, displacement);
    write_vector_image(path, displacement);
}

PointMap read_point_map(const fs::path& source, Sense sense) {
    const bool forward = sense == Sense::reference_to_target;
    std::error_code error;
    if (!fs::is_directory(source, error)) return {read_field(source), !forward};
    if (const auto file = file_in(source, sense)) return {read_field(*file), false};
    const Sense other = forward ? Sense::target_to_reference : Sense::reference_to_target;
    if (const auto file = file_in(source, other)) return {read_field(*file), true};
    no_field_in(source);
}

Image<Vec3> read_written_field(const fs::path& source, Sense sense) {
    const bool forward = sense == Sense::reference_to_target;
    std::error_code error;
    if (!fs::is_directory(source, error)) {
        if (forward) return read_field(source);
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{} holds one displacement field, and not its inverse; give a "
                                "result folder, or leave --inverse out",
                                source.string()));
    }
    if (const auto file = file_in(source, sense)) return read_field(*file);
    const Sense other = forward ? Sense::target_to_reference : Sense::reference_to_target;
    if (!file_in(source, other)) no_field_in(source);
    throw Error(ErrorCode::input_unreadable,
                fmt::format("{} holds no {}; run `palpate recover` again", source.string(),
                            names_of(sense).field));
}

}  // namespace palpate
