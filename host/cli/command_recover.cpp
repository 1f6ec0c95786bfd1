// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <map>
#include <memory>

#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/options.hpp"
#include "host/pipeline/recover.hpp"
#include "host/report/result_folder.hpp"
#include "host/report/text_report.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct RecoverArguments {
    std::string reference, target, config, out, mesh, transform;
    std::string align = "auto", method = "map";
    SolverArguments solver;
    MesherArguments mesher;
    int max_iterations = MapOptions{}.max_iterations;
    double search_time_s = 0;
    bool overwrite = false, quiet = false, keep_file_names = false;
};

AlignMethod align_method(const std::string& name) {
    static const std::map<std::string, AlignMethod> methods{{"auto", AlignMethod::automatic},
                                                            {"fixed", AlignMethod::fixed},
                                                            {"centroid", AlignMethod::centroid},
                                                            {"none", AlignMethod::none}};
    return methods.at(name);
}

int run_recover(const RecoverArguments& arguments) {
    check_result_folder(arguments.out, arguments.overwrite);
    RecoverOptions options;
    options.settings = read_settings(arguments.config);
    options.mesh = arguments.mesh;
    options.initial_transform = arguments.transform;
    options.align = align_method(arguments.align);
    options.mesher = mesher_options(arguments.mesher);
    options.solver = solver_options(arguments.solver);
    options.search.max_iterations = arguments.max_iterations;
    options.method = arguments.method == "map" ? SearchMethod::map : SearchMethod::nested_lbfgs;
    options.nested.max_outer_iterations = arguments.max_iterations;
    options.nested.time_limit_s = arguments.search_time_s;
    options.nested.direct_library = options.solver.direct_library;

    const auto progress = console_progress(arguments.quiet);
    report_progress(progress, "reading", 0, "reading both segmentations");
    const RecoveryResult result = recover(read_segmentation(arguments.reference),
                                          read_segmentation(arguments.target), options, progress);
    report_progress(progress, "writing", 0, "result folder");
    ResultOptions writing;
    writing.overwrite = arguments.overwrite;
    writing.include_file_names = arguments.keep_file_names;
    write_result(result, arguments.out, writing);
    end_progress_line();
    fmt::print("{}\nreport: {}/report.html\n", text_report(result), arguments.out);
    return result.termination.converged ? 0 : exit_code_not_converged;
}

}  // namespace

void add_recover(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<RecoverArguments>();
    CLI::App* command = app.add_subcommand(
        "recover", "Stiffness, forces and deformation from two segmentations of one patient");
    command->add_option("reference", arguments->reference, "Label volume, state one")->required();
    command->add_option("target", arguments->target, "Label volume, state two")->required();
    command->add_option("--config", arguments->config, "Organs and their roles (TOML)")->required();
    command->add_option("--out", arguments->out, "Result folder, made new")->required();
    command->add_flag("--overwrite", arguments->overwrite, "Replace an older result folder");
    CLI::Option* align =
        command
            ->add_option("--align", arguments->align,
                         "Rigid alignment first: auto (fixed organs if there are any, else "
                         "centroids), fixed, centroid, none")
            ->check(CLI::IsMember({"auto", "fixed", "centroid", "none"}))
            ->capture_default_str();
    command
        ->add_option("--initial-transform", arguments->transform,
                     "Rigid ITK transform (.tfm .txt .h5) from reference to target points, used "
                     "instead of --align")
        ->excludes(align);
    command->add_option("--mesh", arguments->mesh,
                        "Ready mesh of the reference (.vtu, cell array 'region' with labels)");
    command
        ->add_option("--method", arguments->method,
                     "Search: map (with intervals), nested-lbfgs (the published baseline: slow, "
                     "no intervals)")
        ->check(CLI::IsMember({"map", "nested-lbfgs"}))
        ->capture_default_str();
    command
        ->add_option("--search-time", arguments->search_time_s,
                     "Seconds after which nested-lbfgs stops with its best point; 0: no limit")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--max-iterations", arguments->max_iterations, "Of the search")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command->add_flag("--keep-file-names", arguments->keep_file_names,
                      "Write the names of the input files into the result");
    command->add_flag("--quiet", arguments->quiet, "No progress");
    add_mesher_options(*command, arguments->mesher);
    add_solver_options(*command, arguments->solver);
    command->callback([arguments, &run] { run = [arguments] { return run_recover(*arguments); }; });
}

}  // namespace palpate
