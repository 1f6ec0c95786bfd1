// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>

#include "host/apps/recover/report/result_folder.hpp"
#include "host/apps/simulate/simulation_findings.hpp"
#include "host/apps/simulate/simulation_folder.hpp"
#include "host/faces/cli/commands.hpp"
#include "host/faces/cli/console.hpp"
#include "host/faces/cli/options.hpp"
#include "host/faces/cli/time_limit.hpp"
#include "host/system/interrupt.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct SimulateArguments {
    std::string model, out;
    SolverArguments solver;
    double time_limit_s = 0;
    bool overwrite = false, quiet = false;
};

int run_simulate(const SimulateArguments& arguments) {
    check_simulation_folder(arguments.out, arguments.overwrite);
    will_write(arguments.out);
    const TimeLimit limit(arguments.time_limit_s);
    const auto progress = limit.watched(console_progress(arguments.quiet));
    SimulationSettings settings = read_simulation(arguments.model);
    settings.newton.linear = tangent_options(arguments.solver);
    settings.newton.loops = {settings.newton.linear.backend, settings.newton.linear.device,
                             arguments.solver.backend != "auto"};
    const SimulationResult result = run_simulation(settings, progress);
    report_progress(progress, "writing", 0, "result folder");
    write_simulation(result, arguments.out, arguments.overwrite);
    end_progress_line();
    for (const std::string& sentence : simulation_sentences(result)) fmt::print("{}\n", sentence);
    fmt::print("report: {}/report.html\n", arguments.out);
    return result.converged() ? 0 : exit_code_not_converged;
}

}  // namespace

void add_simulate(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<SimulateArguments>();
    CLI::App* command = app.add_subcommand(
        "simulate", "Deform a body of known tissue: forces and displacements in, fields out");
    command->add_option("model", arguments->model, "Mesh, tissues and loads (TOML)")->required();
    command->add_option("--out", arguments->out, "Result folder, made new")->required();
    command->add_flag("--overwrite", arguments->overwrite, "Replace an older result folder");
    add_tangent_options(*command, arguments->solver);
    add_time_limit_option(*command, arguments->time_limit_s);
    command->add_flag("--quiet", arguments->quiet, "No progress");
    command->callback(
        [arguments, &run] { run = [arguments] { return run_simulate(*arguments); }; });
}

}  // namespace palpate
