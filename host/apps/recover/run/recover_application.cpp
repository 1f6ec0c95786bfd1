// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/run/recover_application.hpp"

#include <fmt/core.h>

#include "host/apps/recover/pipeline/plan.hpp"
#include "host/apps/recover/pipeline/recover.hpp"
#include "host/apps/recover/pipeline/repeated_contours.hpp"
#include "host/apps/recover/pipeline/saved_reference_file.hpp"
#include "host/apps/recover/report/recovery_tree.hpp"
#include "host/apps/recover/report/result_folder.hpp"
#include "host/apps/recover/report/targets_page.hpp"
#include "host/apps/recover/report/targets_report.hpp"
#include "host/apps/recover/report/targets_tree.hpp"
#include "host/apps/recover/report/text_report.hpp"
#include "host/apps/recover/run/patient_images.hpp"
#include "host/apps/recover/run/recover_table.hpp"
#include "host/apps/recover/run/target_shapes.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

int exit_code_for(const RecoveryResult& result) {
    return result.termination.converged ? 0 : exit_code_not_converged;
}

/// An error is worse than not converging, which is worse than success; the first error counts.
int worse(int a, int b) {
    if (a == 0 || (a == exit_code_not_converged && b != 0)) return b;
    return a;
}

/// One run of the table's values, after everything that can be told early was checked.
class Recovery {
public:
    Recovery(const OptionValues& values, const ProgressSink& progress)
        : values_(values),
          progress_(progress),
          folder_(values.path("out")),
          target_paths_(values.texts("target")),
          has_shapes_(has_shapes(values)),
          image_paths_(image_paths(values, target_paths_.size())) {
        if (folder_.empty())
            throw Error(ErrorCode::invalid_argument,
                        "--out is required; see `palpate recover --help`");
        if (has_several() && values.is_given("landmarks"))
            throw Error(ErrorCode::invalid_argument,
                        "--landmarks belong to one target; recover the targets one by one");
        const bool overwrite = values.flag("overwrite");
        if (has_several()) {
            names_ = values.flag("keep_file_names")
                         ? target_folder_names({target_paths_.begin(), target_paths_.end()})
                         : numbered_folder_names(target_paths_.size());
            check_targets_folder(folder_, names_, overwrite);
        } else {
            check_result_folder(folder_, overwrite);
        }
        if (!values.text("save_reduced").empty())
            check_saved_reference_path(values.path("save_reduced"), overwrite);
        options_ = recover_options_of(values);
    }

    Outcome run() { return has_several() ? recover_several() : recover_one(); }

private:
    bool has_several() const { return target_paths_.size() > 1; }

    void read(const char* message) {
        report_progress(progress_, "reading", 0, message);
        reference_ = read_segmentation(values_.text("reference"), progress_);
        measure_contours();
        for (const auto& path : target_paths_)
            targets_.push_back(read_segmentation(path, progress_));
        images_.reference =
            read_reference_image(image_paths_, options_.settings, reference_, progress_);
    }

    /// The contours' error between the reference and its repetition, if there is one, into the
    /// settings.
    void measure_contours() {
        if (values_.text("repeated_reference").empty()) return;
        std::optional<double>& sd_mm = options_.settings.prior.contour_sd_mm;
        if (sd_mm)
            throw Error(ErrorCode::invalid_argument,
                        "--repeated-reference measures what contour_sd_mm in the settings gives; "
                        "set it to \"unknown\" or leave the file out");
        report_progress(progress_, "contours", 0, "comparing the reference with its repetition");
        const Segmentation repeated =
            read_segmentation(values_.text("repeated_reference"), progress_);
        sd_mm = contour_sd_of(reference_, repeated, options_.settings);
        report_progress(progress_, "contours", 1,
                        fmt::format("the two are off by {:.2f} mm each", *sd_mm));
    }

    std::optional<PatientImage> target_image(std::size_t k) const {
        return read_target_image(image_paths_, k, options_.settings, targets_[k], progress_);
    }

    ResultOptions writing() const {
        return {.overwrite = values_.flag("overwrite"),
                .include_file_names = values_.flag("keep_file_names"),
                .fields = field_choice_of(values_.text("fields")),
                .images = images_.shown()};
    }

    /// The folder of one target.
    void write(RecoveryResult& result, const std::filesystem::path& folder) const {
        report_progress(progress_, "writing", 0, "result folder");
        images_.add_warnings(result);
        write_result(result, folder, writing());
    }

    Outcome recover_one() {
        const PartialTarget shapes = has_shapes_ ? target_of_shapes(values_) : PartialTarget{};
        read(has_shapes_ ? "reading the segmentation" : "reading both segmentations");
        if (!has_shapes_) images_.target = target_image(0);
        RecoveryResult result = has_shapes_
                                    ? recover(reference_, shapes, options_, progress_)
                                    : recover(reference_, targets_.front(), options_, progress_);
        write(result, folder_);
        const ResultOptions as = writing();
        return {recovery_tree(result, as.include_file_names, as.fields),
                fmt::format("{}\nreport: {}/report.html\n", text_report(result), folder_.string()),
                exit_code_for(result)};
    }

    /// One result folder per target, and the table of all, which grows as they are done.
    Outcome recover_several() {
        read("reading the segmentations");
        for (std::size_t k = 0; k < targets_.size(); ++k) target_image(k);  // to refuse it early
        std::vector<TargetRow> rows;
        Outcome outcome;
        const auto add = [&](TargetRow row, int code) {
            rows.push_back(std::move(row));
            outcome.exit_code = worse(outcome.exit_code, code);
            write_targets_files(folder_, targets_csv(rows), targets_page(rows, version_text()));
        };
        const auto found = [&](std::size_t k, RecoveryResult result, double seconds) {
            images_.target = target_image(k);
            write(result, folder_ / names_[k]);
            images_.target.reset();
            add(target_row(names_[k], result, seconds), exit_code_for(result));
        };
        const auto failed = [&](std::size_t k, const Error& error) {
            add(failed_row(names_[k], error.what()), exit_code_of(error.code()));
        };
        const auto joint = [&](JointResult result) {
            const int code = result.failure.empty() ? 0 : exit_code_of(ErrorCode::solve_failed);
            add(joint_row(std::move(result), names_), code);
        };
        recover_all(reference_, targets_, options_, {found, failed, joint}, progress_);
        outcome.result = targets_tree(rows);
        outcome.text = fmt::format("{}\nreports: {}/*/report.html, of all: {}/{}, table: {}/{}\n",
                                   targets_table(rows), folder_.string(), folder_.string(),
                                   targets_page_name, folder_.string(), targets_file_name);
        return outcome;
    }

    const OptionValues& values_;
    const ProgressSink& progress_;
    std::filesystem::path folder_;
    std::vector<std::string> target_paths_, names_;  ///< names of the folders of several
    bool has_shapes_;
    ImagePaths image_paths_;
    RecoverOptions options_;
    Segmentation reference_;
    std::vector<Segmentation> targets_;
    PatientImages images_;
};

/// Nothing is written: what targets would tell is for the terminal.
Outcome run_plan(const OptionValues& values, const ProgressSink& progress) {
    for (const char* name : {"target", "target_surface", "target_points"})
        if (values.is_given(name))
            throw Error(ErrorCode::invalid_argument,
                        "--plan is for a reference alone; give no target, or leave --plan out");
    const RecoverOptions options = recover_options_of(values);
    const PlanOptions plan = plan_options_of(values);
    const std::vector<PlanRow> rows = plan_recovery(
        read_segmentation(values.text("reference"), progress), options, plan, progress);
    const double contour_mm = planned_contour_mm(plan, options.settings);
    return {plan_tree(rows, plan.motion_mm, contour_mm),
            fmt::format(
                "Upper over lower end of the 95 % interval to expect, if walls move by {:g} mm and "
                "the\ncontours of each image are {:g} mm off:\n\n{}\n"
                "Targets fuller and emptier than the reference tell more than as many on one side: "
                "the\nerror of the reference's contours cancels. More motion tells more, until "
                "what the model\nitself adds is left (docs/method.md). \"nothing\": not "
                "identifiable.\n",
                plan.motion_mm, contour_mm, plan_table(rows)),
            0};
}

Outcome run_recover(const OptionValues& values, const ProgressSink& progress) {
    return values.flag("plan") ? run_plan(values, progress) : Recovery(values, progress).run();
}

}  // namespace

Application recover_application() {
    return {"recover", "Stiffness, forces and deformation from two segmentations of one patient",
            recover_table(), run_recover};
}

}  // namespace palpate
