// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>
#include <optional>

#include "host/apps/recover/pipeline/landmarks.hpp"
#include "host/apps/recover/pipeline/plan.hpp"
#include "host/apps/recover/pipeline/recover.hpp"
#include "host/apps/recover/pipeline/repeated_contours.hpp"
#include "host/apps/recover/pipeline/saved_reference_file.hpp"
#include "host/apps/recover/report/result_folder.hpp"
#include "host/apps/recover/report/targets_page.hpp"
#include "host/apps/recover/report/targets_report.hpp"
#include "host/apps/recover/report/text_report.hpp"
#include "host/faces/cli/commands.hpp"
#include "host/faces/cli/console.hpp"
#include "host/faces/cli/image_options.hpp"
#include "host/faces/cli/options.hpp"
#include "host/faces/cli/partial_target_options.hpp"
#include "host/faces/cli/time_limit.hpp"
#include "host/system/interrupt.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct RecoverArguments {
    std::string reference, config, out, mesh, transform, save_reduced, load_reduced;
    std::string repeated_reference;  ///< the reference's image, segmented once more
    std::vector<std::string> targets;
    PartialTargetArguments partial;
    ImageArguments images;
    std::string align = "auto", method = "map", material = name_of(TissueLaw::linear),
                fields = "one";
    SolverArguments solver;
    MesherArguments mesher;
    int max_iterations = MapOptions{}.max_iterations;
    double start_kpa = MapOptions{}.start_kpa;
    double search_time_s = 0, time_limit_s = 0;
    std::vector<std::string> landmarks;  ///< a file for each state
    bool landmarks_ras = false;
    bool overwrite = false, quiet = false, keep_file_names = false, is_plan = false;
    PlanOptions plan;
};

RecoverOptions recover_options(const RecoverArguments& arguments) {
    RecoverOptions options;
    options.settings = read_settings(arguments.config);
    options.mesh = arguments.mesh;
    options.initial_transform = arguments.transform;
    options.align = align_method_of(arguments.align);
    options.mesher = mesher_options(arguments.mesher);
    options.solver = solver_options(arguments.solver);
    options.search.max_iterations = arguments.max_iterations;
    options.search.start_kpa = arguments.start_kpa;
    options.method = arguments.method == "map" ? SearchMethod::map : SearchMethod::nested_lbfgs;
    options.law = tissue_law_of(arguments.material);
    options.nested.max_outer_iterations = arguments.max_iterations;
    options.nested.time_limit_s = arguments.search_time_s;
    options.nested.direct_library = options.solver.direct_library;
    if (!arguments.landmarks.empty())
        options.landmarks =
            read_landmarks(arguments.landmarks[0], arguments.landmarks[1],
                           arguments.landmarks_ras ? PointAxes::ras : PointAxes::lps);
    options.save_reduced = arguments.save_reduced;
    options.load_reduced = arguments.load_reduced;
    return options;
}

/// Writes the result of one target.
void write(const RecoverArguments& arguments, RecoveryResult& result, const PatientImages& images,
           const std::filesystem::path& folder, const ProgressSink& progress) {
    report_progress(progress, "writing", 0, "result folder");
    images.add_warnings(result);
    ResultOptions writing;
    writing.overwrite = arguments.overwrite;
    writing.include_file_names = arguments.keep_file_names;
    writing.fields = field_choice_of(arguments.fields);
    writing.images = images.shown();
    write_result(result, folder, writing);
}

/// The contours' error between the reference and its repetition, if there is one, into the
/// settings.
void measure_contours(const RecoverArguments& arguments, const Segmentation& reference,
                      RecoverOptions& options, const ProgressSink& progress) {
    if (arguments.repeated_reference.empty()) return;
    std::optional<double>& sd_mm = options.settings.prior.contour_sd_mm;
    if (sd_mm)
        throw Error(ErrorCode::invalid_argument,
                    "--repeated-reference measures what contour_sd_mm in the settings gives; set "
                    "it to \"unknown\" or leave the file out");
    report_progress(progress, "contours", 0, "comparing the reference with its repetition");
    sd_mm = contour_sd_of(reference, read_segmentation(arguments.repeated_reference, progress),
                          options.settings);
    report_progress(progress, "contours", 1,
                    fmt::format("the two are off by {:.2f} mm each", *sd_mm));
}

int exit_code_for(const RecoveryResult& result) {
    return result.termination.converged ? 0 : exit_code_not_converged;
}

std::vector<Segmentation> read_targets(const RecoverArguments& arguments,
                                       const ProgressSink& progress) {
    std::vector<Segmentation> targets;
    for (const auto& target : arguments.targets)
        targets.push_back(read_segmentation(target, progress));
    return targets;
}

int recover_one(const RecoverArguments& arguments, RecoverOptions options,
                const ProgressSink& progress) {
    const bool partial = has_shapes(arguments.partial);
    const PartialTarget shapes = partial ? partial_target(arguments.partial) : PartialTarget{};
    report_progress(progress, "reading", 0,
                    partial ? "reading the segmentation" : "reading both segmentations");
    const Segmentation reference = read_segmentation(arguments.reference, progress);
    measure_contours(arguments, reference, options, progress);
    const std::vector<Segmentation> targets = read_targets(arguments, progress);
    PatientImages images;
    images.reference =
        read_reference_image(arguments.images, options.settings, reference, progress);
    if (!partial)
        images.target =
            read_target_image(arguments.images, 0, options.settings, targets.front(), progress);
    RecoveryResult result = partial ? recover(reference, shapes, options, progress)
                                    : recover(reference, targets.front(), options, progress);
    write(arguments, result, images, arguments.out, progress);
    end_progress_line();
    fmt::print("{}\nreport: {}/report.html\n", text_report(result), arguments.out);
    return exit_code_for(result);
}

/// An error is worse than not converging, which is worse than success; the first error counts.
int worse(int a, int b) {
    if (a == 0 || (a == exit_code_not_converged && b != 0)) return b;
    return a;
}

/// One result folder per target, and the table of all, which grows as they are done.
int recover_several(const RecoverArguments& arguments, RecoverOptions options,
                    const std::vector<std::string>& names, const ProgressSink& progress) {
    const std::filesystem::path folder = arguments.out;
    std::vector<TargetRow> rows;
    int exit_code = 0;
    const auto add = [&](TargetRow row, int code) {
        rows.push_back(std::move(row));
        exit_code = worse(exit_code, code);
        write_targets_files(folder, targets_csv(rows), targets_page(rows, version_text()));
    };
    report_progress(progress, "reading", 0, "reading the segmentations");
    const Segmentation reference = read_segmentation(arguments.reference, progress);
    measure_contours(arguments, reference, options, progress);
    const std::vector<Segmentation> targets = read_targets(arguments, progress);
    PatientImages images;
    images.reference =
        read_reference_image(arguments.images, options.settings, reference, progress);
    const auto target_image = [&](std::size_t k) {
        return read_target_image(arguments.images, k, options.settings, targets[k], progress);
    };
    for (std::size_t k = 0; k < targets.size(); ++k) target_image(k);  // to refuse it early
    recover_all(reference, targets, options,
                {[&](std::size_t k, RecoveryResult result, double seconds) {
                     images.target = target_image(k);
                     write(arguments, result, images, folder / names[k], progress);
                     images.target.reset();
                     add(target_row(names[k], result, seconds), exit_code_for(result));
                 },
                 [&](std::size_t k, const Error& error) {
                     add(failed_row(names[k], error.what()), exit_code_of(error.code()));
                 },
                 [&](JointResult result) {
                     const int code =
                         result.failure.empty() ? 0 : exit_code_of(ErrorCode::solve_failed);
                     add(joint_row(std::move(result), names), code);
                 }},
                progress);
    end_progress_line();
    fmt::print("{}\nreports: {}/*/report.html, of all: {}/{}, table: {}/{}\n", targets_table(rows),
               arguments.out, arguments.out, targets_page_name, arguments.out, targets_file_name);
    return exit_code;
}

/// Nothing is written: what targets would tell is for the terminal.
int run_plan(const RecoverArguments& arguments) {
    if (!arguments.targets.empty() || has_shapes(arguments.partial))
        throw Error(ErrorCode::invalid_argument,
                    "--plan is for a reference alone; give no target, or leave --plan out");
    RecoverOptions options = recover_options(arguments);
    const TimeLimit limit(arguments.time_limit_s);
    const auto progress = limit.watched(console_progress(arguments.quiet));
    const std::vector<PlanRow> rows = plan_recovery(
        read_segmentation(arguments.reference, progress), options, arguments.plan, progress);
    end_progress_line();
    fmt::print(
        "Upper over lower end of the 95 % interval to expect, if walls move by {:g} mm and the\n"
        "contours of each image are {:g} mm off:\n\n{}\n"
        "Targets fuller and emptier than the reference tell more than as many on one side: the\n"
        "error of the reference's contours cancels. More motion tells more, until what the model\n"
        "itself adds is left (docs/method.md). \"nothing\": not identifiable.\n",
        arguments.plan.motion_mm, planned_contour_mm(arguments.plan, options.settings),
        plan_table(rows));
    return 0;
}

int run_recover(const RecoverArguments& arguments) {
    if (arguments.is_plan) return run_plan(arguments);
    if (arguments.out.empty())
        throw Error(ErrorCode::invalid_argument, "--out is required; see `palpate recover --help`");
    check_one_kind_of_target(arguments.targets, arguments.partial);
    check_images(arguments.images, arguments.targets.size());
    if (arguments.targets.size() > 1 && !arguments.landmarks.empty())
        throw Error(ErrorCode::invalid_argument,
                    "--landmarks belong to one target; recover the targets one by one");
    const bool several = arguments.targets.size() > 1;
    std::vector<std::string> names;
    if (several) {
        names = arguments.keep_file_names
                    ? target_folder_names({arguments.targets.begin(), arguments.targets.end()})
                    : numbered_folder_names(arguments.targets.size());
        check_targets_folder(arguments.out, names, arguments.overwrite);
    } else {
        check_result_folder(arguments.out, arguments.overwrite);
    }
    if (!arguments.save_reduced.empty()) {
        check_saved_reference_path(arguments.save_reduced, arguments.overwrite);
    }
    const RecoverOptions options = recover_options(arguments);
    will_write(arguments.out);
    will_write(arguments.save_reduced);
    const TimeLimit limit(arguments.time_limit_s);
    const auto progress = limit.watched(console_progress(arguments.quiet));
    return several ? recover_several(arguments, options, names, progress)
                   : recover_one(arguments, options, progress);
}

/// What a plan makes no use of. To be called after all other options were added.
void exclude_from_plan(CLI::App& command) {
    CLI::Option* plan = command.get_option("--plan");
    for (const char* name :
         {"--out", "--overwrite", "--initial-transform", "--repeated-reference", "--method",
          "--material", "--search-time", "--start-kpa", "--max-iterations", "--landmarks",
          "--landmarks-ras", "--fields", "--keep-file-names", "--reference-image", "--target-image",
          "--save-reduced", "--load-reduced"})
        plan->excludes(command.get_option(name));
}

/// To be called after the options of mesh and mesher were added.
void add_reduced_options(CLI::App& command, RecoverArguments& arguments) {
    CLI::Option* save = command.add_option(
        "--save-reduced", arguments.save_reduced,
        "File, made new, for the mesh and the reduced model of the reference, for --load-reduced");
    CLI::Option* load = command.add_option(
        "--load-reduced", arguments.load_reduced,
        "Such a file of the same reference and settings: no meshing, no condensing");
    load->excludes(save);
    for (const char* name :
         {"--mesh", "--mesher", "--nodes", "--mesh-time-limit", "--mesh-memory-limit"}) {
        load->excludes(command.get_option(name));
    }
}

}  // namespace

void add_recover(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<RecoverArguments>();
    CLI::App* command = app.add_subcommand(
        "recover", "Stiffness, forces and deformation from two segmentations of one patient");
    command->add_option("reference", arguments->reference, "Label volume, state one")->required();
    command->add_option("target", arguments->targets,
                        "Label volume, state two; of several, each gets a numbered folder in "
                        "--out; instead of it: --target-surface, --target-points");
    command->add_option("--config", arguments->config, "Organs and their roles (TOML)")->required();
    command->add_option("--out", arguments->out, "Result folder, made new; needed but for --plan");
    command->add_flag("--overwrite", arguments->overwrite,
                      "Replace an older result folder or --save-reduced file");
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
    CLI::Option* plan = command->add_flag(
        "--plan", arguments->is_plan,
        "Tell what interval to expect of how many targets, from the reference alone");
    command
        ->add_option("--plan-motion", arguments->plan.motion_mm,
                     "How far driven walls will move, mm along their normals")
        ->check(CLI::Range(0.1, 50.0))
        ->needs(plan)
        ->capture_default_str();
    command
        ->add_option("--plan-contours", arguments->plan.contour_mm,
                     "How far contours will be off in each image, mm (standard deviation; "
                     "default: contour_sd_mm of the settings, or 0.5)")
        ->check(CLI::Range(0.0, largest_contour_sd_mm))
        ->needs(plan);
    command->add_option("--repeated-reference", arguments->repeated_reference,
                        "The reference's image segmented once more, independently: measures how "
                        "far contours are off (contour_sd_mm)");
    add_partial_target_options(*command, arguments->partial);
    add_image_options(*command, arguments->images);
    command
        ->add_option("--landmarks", arguments->landmarks,
                     "Two CSV files (x, y, z in mm) with the same points in both images, row by "
                     "row: their error is told, the search does not use them")
        ->expected(2);
    command->add_flag("--landmarks-ras", arguments->landmarks_ras, "These files are RAS, not LPS");
    command->add_option("--mesh", arguments->mesh,
                        "Ready mesh of the reference (.vtu, cell array 'region' with labels)");
    command
        ->add_option("--method", arguments->method,
                     "Search: map (with intervals), nested-lbfgs (the published baseline: slow, "
                     "no intervals)")
        ->check(CLI::IsMember({"map", "nested-lbfgs"}))
        ->capture_default_str();
    command
        ->add_option("--material", arguments->material,
                     "Law of all tissue: linear (small strains), neo-hookean (large deformation; "
                     "about three times the time)")
        ->check(CLI::IsMember({"linear", "neo-hookean"}))
        ->capture_default_str();
    command
        ->add_option("--search-time", arguments->search_time_s,
                     "Seconds after which nested-lbfgs stops with its best point; 0: no limit")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--start-kpa", arguments->start_kpa,
                     "Stiffness at which the search starts (default: the prior's median)")
        ->check(CLI::Range(0.1, 1e5));
    command->add_option("--max-iterations", arguments->max_iterations, "Of the search")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command
        ->add_option("--fields", arguments->fields,
                     "Displacement fields in the result: none, one (NIfTI, for each direction), "
                     "all (ITK transforms .h5, too)")
        ->check(CLI::IsMember({"none", "one", "all"}))
        ->capture_default_str();
    command->add_flag("--keep-file-names", arguments->keep_file_names,
                      "Write the names of the input files into the result, and name the folders of "
                      "several targets after them");
    add_time_limit_option(*command, arguments->time_limit_s);
    command->add_flag("--quiet", arguments->quiet, "No progress");
    add_mesher_options(*command, arguments->mesher);
    add_reduced_options(*command, *arguments);
    add_solver_options(*command, arguments->solver);
    exclude_from_plan(*command);
    command->callback([arguments, &run] { run = [arguments] { return run_recover(*arguments); }; });
}

}  // namespace palpate
