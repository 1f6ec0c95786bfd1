// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "host/apps/export/write_model.hpp"
#include "host/faces/cli/commands.hpp"
#include "host/faces/cli/output_file.hpp"
#include "host/geometry/warping/field_files.hpp"
#include "host/io/displacement_steps.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct ExportArguments {
    std::string result, out;
    std::optional<WallLoad> walls;
    bool inverse = false, overwrite = false;
};

const std::map<std::string, WallLoad> wall_loads{{"displacement", WallLoad::displacement},
                                                 {"force", WallLoad::force}};

/// A file says nothing about which way its displacements lead; a result folder does.
std::string told_sense(const ExportArguments& arguments) {
    std::error_code error;
    if (!std::filesystem::is_directory(arguments.result, error)) return "";
    return arguments.inverse ? ", target to reference" : ", reference to target";
}

int export_field(const ExportArguments& arguments) {
    if (arguments.walls)
        throw Error(
            ErrorCode::invalid_argument,
            "--walls belongs to models (.feb, .inp); leave it out for a displacement field");
    const Sense sense = arguments.inverse ? Sense::target_to_reference : Sense::reference_to_target;
    const Image<Vec3> field = read_written_field(arguments.result, sense);
    write_field(arguments.out, field);
    const auto& size = field.grid.size;
    fmt::print("{}: {} x {} x {} displacements in mm, LPS{}{}\n", arguments.out, size[0], size[1],
               size[2], told_sense(arguments),
               is_rounded_by_writing(field) ? ", rounded to 1/128 mm" : "");
    return 0;
}

int export_model(const ExportArguments& arguments) {
    if (arguments.inverse)
        throw Error(ErrorCode::invalid_argument,
                    "--inverse belongs to displacement fields (.nii.gz, .h5); leave it out for a "
                    "model");
    const RecoveredModel model = read_recovered_model(arguments.result);
    write_model(model, arguments.walls.value_or(WallLoad::displacement), arguments.out);
    fmt::print("{}: {} nodes, {} tetrahedra, {} regions, law {}\n", arguments.out,
               model.mesh.num_nodes(), model.mesh.num_tets(), model.regions.size(), model.law.name);
    return 0;
}

int run_export(const ExportArguments& arguments) {
    check_output_file(arguments.out, arguments.overwrite);
    return is_field_file(arguments.out) ? export_field(arguments) : export_model(arguments);
}

}  // namespace

void add_export(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command = app.add_subcommand(
        "export",
        "Write a recovered model for FEBio, CalculiX, Gmsh or ParaView, or a displacement field in "
        "the other format");
    command
        ->add_option("result", arguments->result,
                     "Result folder of `palpate recover`; for .nii.gz and .h5 a displacement field "
                     "will do")
        ->required();
    command
        ->add_option("--out", arguments->out,
                     "File to write: .feb, .inp, .msh or .vtu (model), .nii.gz or .h5 (field)")
        ->required();
    command->add_flag("--inverse", arguments->inverse,
                      "The field from the target to the reference (.nii.gz, .h5)");
    command
        ->add_option("--walls", arguments->walls,
                     "What moves the driven organs' walls (.feb, .inp): displacement or force")
        ->transform(CLI::CheckedTransformer(wall_loads))
        ->default_str("displacement");
    command->add_flag("--overwrite", arguments->overwrite, "Replace an older file");
    command->callback([arguments, &run] { run = [arguments] { return run_export(*arguments); }; });
}

}  // namespace palpate
