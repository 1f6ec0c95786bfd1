// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/pipeline/version.hpp"
#include "host/program/memory_limit.hpp"
#include "host/program/run_program.hpp"
#include "solver/base/error.hpp"

namespace {

int parse_and_run(int argc, char** argv) {
    CLI::App app{
        "Computational palpation: stiffness, forces and deformation from two segmentations"};
    app.name("palpate");
    app.set_version_flag("--version", "palpate " + palpate::version_text());
    app.require_subcommand(1);
    app.footer(
        "Exit codes: 0 ok, 1 internal, 2 usage, 3 unreadable input, 4 unusable input, 5 meshing,\n"
        "6 forward solve, 7 not converged (result written), 8 device, 9 time limit or cancelled,\n"
        "10 output.\n"
        "Not a medical device.");
    palpate::Run run;
    palpate::add_recover(app, run);
    palpate::add_phantom(app, run);
    palpate::add_simulate(app, run);
    palpate::add_study(app, run);
    palpate::add_warp(app, run);
    palpate::add_export(app, run);
    palpate::add_devices(app, run);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        throw palpate::Error(palpate::ErrorCode::invalid_argument,
                             fmt::format("{}; see `palpate --help`", error.what()));
    }
    palpate::prepare_for_memory_limit();
    return run();
}

}  // namespace

int main(int argc, char** argv) {
    palpate::run_program(
        "palpate", [&] { return parse_and_run(argc, argv); }, palpate::end_progress_line);
}
