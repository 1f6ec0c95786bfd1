// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <memory>

#include "host/cli/commands.hpp"
#include "host/cli/output_file.hpp"
#include "host/exporting/write_model.hpp"

namespace palpate {
namespace {

struct ExportArguments {
    std::string result, out;
    WallLoad walls = WallLoad::displacement;
    bool overwrite = false;
};

const std::map<std::string, WallLoad> wall_loads{{"displacement", WallLoad::displacement},
                                                 {"force", WallLoad::force}};

int run_export(const ExportArguments& arguments) {
    check_output_file(arguments.out, arguments.overwrite);
    const RecoveredModel model = read_recovered_model(arguments.result);
    write_model(model, arguments.walls, arguments.out);
    fmt::print("{}: {} nodes, {} tetrahedra, {} regions, law {}\n", arguments.out,
               model.mesh.num_nodes(), model.mesh.num_tets(), model.regions.size(),
               name_of(model.law));
    return 0;
}

}  // namespace

void add_export(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command = app.add_subcommand(
        "export", "Write a recovered model for FEBio, CalculiX, Gmsh or ParaView");
    command->add_option("result", arguments->result, "Result folder of `palpate recover`")
        ->required();
    command->add_option("--out", arguments->out, "File to write: .feb, .inp, .msh or .vtu")
        ->required();
    command
        ->add_option("--walls", arguments->walls,
                     "What moves the driven organs' walls (.feb, .inp): displacement or force")
        ->transform(CLI::CheckedTransformer(wall_loads))
        ->default_str("displacement");
    command->add_flag("--overwrite", arguments->overwrite, "Replace an older file");
    command->callback([arguments, &run] { run = [arguments] { return run_export(*arguments); }; });
}

}  // namespace palpate
