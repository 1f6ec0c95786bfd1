// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>
#include <vector>

#include "host/apps/study/run_study.hpp"
#include "host/apps/study/studies.hpp"
#include "host/faces/cli/commands.hpp"
#include "host/faces/cli/console.hpp"
#include "host/faces/cli/options.hpp"
#include "host/system/interrupt.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct StudyArguments {
    StudyOptions study;
    std::vector<double> spacing{1, 1, 1};
    StudyRunOptions run;
    std::string out, contours = "exact", load = "mixed", anatomy = "usual";
    SolverArguments solver;
    MesherArguments mesher;
    bool quiet = false;
};

void print_summary(const Study& study, const StudyRun& run, const std::string& folder) {
    end_progress_line();
    if (!run.rows.empty()) fmt::print("{}", study.report(run.rows).text);
    for (const auto& [id, message] : run.failures) fmt::print("{} failed: {}\n", id, message);
    if (run.is_cancelled)
        fmt::print("stopped after {} of {} cases; the same command goes on\n", run.rows.size(),
                   run.num_cases);
    fmt::print("page: {}/study.html\n", folder);
}

int run_one(const StudyEntry& entry, StudyArguments arguments) {
    StudyOptions& options = arguments.study;
    if (options.phantoms == 0) options.phantoms = entry.phantoms;
    options.spacing = Vec3(arguments.spacing[0], arguments.spacing[1], arguments.spacing[2]);
    options.contours = contour_error_of(arguments.contours);
    options.load = load_family_of(arguments.load);
    options.anatomy = anatomy_family_of(arguments.anatomy);
    options.mesher = mesher_options(arguments.mesher);
    options.solver = solver_options(arguments.solver);
    arguments.run.folder = arguments.out;
    arguments.run.is_cancelled = is_interrupted;
    will_write(arguments.run.folder);
    will_write(arguments.run.folder / "pictures" / "any");

    const Study study = entry.make(options);
    const StudyRun run = run_study(study, arguments.run, console_progress(arguments.quiet));
    write_study_page(study, run, arguments.run.folder);
    print_summary(study, run, arguments.out);
    if (run.is_cancelled) return exit_code_of(ErrorCode::cancelled);
    return run.failures.empty() ? 0 : exit_code_not_converged;
}

void add_run_options(CLI::App& command, StudyArguments& arguments) {
    command
        .add_option("--out", arguments.out,
                    "Folder; one that holds rows of the same study is continued")
        ->required();
    command.add_flag("--overwrite", arguments.run.overwrite, "Begin again");
    command.add_option("--jobs", arguments.run.jobs, "Cases that run at the same time")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    command.add_flag("--quiet", arguments.quiet, "No progress");
}

void add_phantom_options(CLI::App& command, const StudyEntry& entry, StudyArguments& arguments) {
    StudyOptions& options = arguments.study;
    command.add_option("--first-seed", options.first_seed, "Of the phantoms")
        ->capture_default_str();
    command
        .add_option("--phantoms", options.phantoms,
                    fmt::format("How many anatomies (default {})", entry.phantoms))
        ->check(CLI::Range(1, 100000));
    command.add_option("--spacing", arguments.spacing, "Voxel size in mm, three numbers")
        ->expected(3)
        ->check(CLI::Range(0.3, 8.0))
        ->capture_default_str();
    command
        .add_option(
            "--tangential", options.tangential,
            "Factor on the walls' motion along themselves, of which the prior knows nothing")
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    command.add_option("--phantom-nodes", options.phantom_nodes, "Of the meshes of the truths")
        ->check(CLI::Range(1000, 2000000))
        ->capture_default_str();
    command
        .add_option("--load", arguments.load,
                    "How the walls move: mixed, filling, bump, normal, tangential, shift, large; "
                    "or drawn, any but mixed for each phantom")
        ->capture_default_str();
    command
        .add_option("--anatomy", arguments.anatomy,
                    "What kind of organs: usual, round, flat, touching, cut; or drawn, any but "
                    "usual for each phantom")
        ->capture_default_str();
    if (entry.has_images) {
        command
            .add_option("--contours", arguments.contours,
                        "How both volumes are drawn: exact, or STYLE:SD:LENGTH in mm, STYLE one of "
                        "exponential, matern32, squared, slices; or drawn:SD, one of them and 4 to "
                        "12 mm for each phantom")
            ->capture_default_str();
    }
    add_mesher_options(command, arguments.mesher);
}

void add_one(CLI::App& parent, const StudyEntry& entry, Run& run) {
    auto arguments = std::make_shared<StudyArguments>();
    CLI::App* command = parent.add_subcommand(entry.name, entry.about);
    add_run_options(*command, *arguments);
    if (entry.phantoms > 0) add_phantom_options(*command, entry, *arguments);
    add_solver_options(*command, arguments->solver);
    command->callback(
        [arguments, &entry, &run] { run = [=, &entry] { return run_one(entry, *arguments); }; });
}

}  // namespace

void add_study(CLI::App& app, Run& run) {
    CLI::App* command = app.add_subcommand(
        "study", "Recover many phantoms with known answers and judge the errors");
    command->require_subcommand(1);
    for (const StudyEntry& entry : study_registry()) add_one(*command, entry, run);
}

}  // namespace palpate
