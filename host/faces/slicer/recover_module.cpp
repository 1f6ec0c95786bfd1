// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/slicer/recover_module.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "host/apps/recover/report/html_report.hpp"
#include "host/apps/recover/report/result_folder.hpp"
#include "host/apps/recover/report/vtk_report.hpp"
#include "host/apps/recover/run/recover_table.hpp"
#include "host/io/files.hpp"
#include "host/io/output_folder.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

OrganSettings organ_of(Role role, int label) {
    OrganSettings organ;
    organ.name = fmt::format("{}-{}", name_of(role), label);
    organ.label = label;
    organ.role = role;
    organ.hollow = role != Role::tissue;
    return organ;
}

constexpr std::array single_files{"deformation", "warpedLabels", "model", "report"};

/// Throws Error(output_failed) if no file can appear there.
void check_may_write(const std::filesystem::path& file) {
    const auto folder = file.has_parent_path() ? file.parent_path() : ".";
    if (std::filesystem::is_directory(file) || ::access(folder.c_str(), W_OK | X_OK) != 0)
        throw Error(ErrorCode::output_failed,
                    fmt::format("{} cannot be written; choose a file in a folder that exists and "
                                "may be written to",
                                file.string()));
}

/// The files that were asked for: all are made before the first takes its place, so that a failure
/// leaves those of an earlier run as they were.
class Outputs {
public:
    explicit Outputs(const ModuleArguments& arguments) : arguments_(arguments) {}

    template <class Write>
    void write(const char* name, const Write& write) {
        const std::string& file = arguments_.text(name);
        if (file.empty()) return;
        unfinished_.emplace_back(std::make_unique<UnfinishedFile>(file))->write(write);
    }
    void finish() {
        for (const auto& file : unfinished_) file->finish();
    }

private:
    const ModuleArguments& arguments_;
    std::vector<std::unique_ptr<UnfinishedFile>> unfinished_;
};

std::string sentence_about(const RegionResult& region) {
    if (region.verdict == Verdict::not_identifiable) return region.name + " not identifiable";
    return fmt::format("{} {:.1f} kPa ({:.1f} to {:.1f}, {})", region.name, region.stiffness_kpa,
                       region.interval_kpa[0], region.interval_kpa[1], name_of(region.verdict));
}

}  // namespace

Settings module_settings(const ModuleArguments& arguments) {
    if (const std::string& file = arguments.text("settings"); !file.empty())
        return read_settings(file);
    Settings settings;
    settings.background.emplace();
    settings.background->stiffness_kpa = arguments.number("surroundings");
    settings.background->outer_boundary_fixed = !arguments.flag("freeBorder");
    for (const Role role : {Role::tissue, Role::driven, Role::fixed})
        for (const int label : arguments.integers(name_of(role)))
            settings.organs.push_back(organ_of(role, label));
    if (settings.organs.empty())
        throw Error(
            ErrorCode::invalid_argument,
            "no organ was named; give --settings, or labels by --tissue, --driven, --fixed");
    return parse_settings(to_toml(settings), "labels");  // which checks them
}

std::vector<Option> method_options() {
    const std::vector<Option> table = recover_table();
    std::vector<Option> options;
    for (const char* name :
         {"material", "align", "nodes", "element", "mesher", "backend", "device", "precision"})
        options.push_back(*find_option(table, name));
    return options;
}

RecoverOptions module_options(const ModuleArguments& arguments) {
    std::vector<Option> table = recover_table();
    for (Option& option : table) option.is_required = false;  // files have parameters of their own
    OptionWords words;
    for (const Option& option : method_options())
        if (const std::string& text = arguments.text(option.name); !text.empty())
            words[option.name] = {text};
    const RecoverOptions options =
        recover_options_of(OptionValues::from_words(table, words), module_settings(arguments));
    check_module_outputs(arguments);
    return options;
}

void check_module_outputs(const ModuleArguments& arguments) {
    for (const char* name : single_files)
        if (const std::string& file = arguments.text(name); !file.empty()) check_may_write(file);
    if (const std::string& folder = arguments.text("resultFolder"); !folder.empty())
        check_result_folder(folder, true);
}

void write_module_outputs(const ModuleArguments& arguments, const RecoveryResult& result) {
    using std::filesystem::path;
    Outputs outputs(arguments);
    outputs.write("deformation", [&](const path& file) {
        write_displacement_transform(file, result.inverse_displacement_field);
    });
    outputs.write("warpedLabels",
                  [&](const path& file) { write_label_image(file, result.warped_labels); });
    outputs.write("model", [&](const path& file) { write_vtk_report(result, file); });
    outputs.write("report", [&](const path& file) {
        write_text_file(file, html_report(result, false, {}, FieldChoice::none));
    });
    if (const std::string& folder = arguments.text("resultFolder"); !folder.empty()) {
        ResultOptions options;
        options.overwrite = true;
        write_result(result, folder, options);
    }
    outputs.finish();
}

std::string return_parameters(const RecoveryResult& result) {
    std::string first, summary;
    for (const RegionResult& region : result.regions) {
        if (!region.unknown) continue;
        if (first.empty())
            first = fmt::format(
                "stiffness = {:.6g}\nstiffnessLow = {:.6g}\nstiffnessHigh = {:.6g}\n"
                "verdict = {}\n",
                region.stiffness_kpa, region.interval_kpa[0], region.interval_kpa[1],
                name_of(region.verdict));
        summary += (summary.empty() ? "" : "; ") + sentence_about(region);
    }
    if (!result.termination.converged) summary += "; not converged";
    return first + "summary = " + summary + "\n";
}

}  // namespace palpate
