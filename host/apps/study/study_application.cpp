// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/study_application.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "host/apps/compute_options.hpp"
#include "host/apps/recover/modelling/body_mesh.hpp"
#include "host/apps/study/run_study.hpp"
#include "host/apps/study/studies.hpp"
#include "host/system/interrupt.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::vector<std::string> study_names() {
    std::vector<std::string> names;
    for (const StudyEntry& entry : study_registry()) names.push_back(entry.name);
    return names;
}

/// "coverage: ...; recovery: ..."
std::string what_each_asks() {
    std::string text;
    for (const StudyEntry& entry : study_registry())
        text += fmt::format("{}{}: {}{}", text.empty() ? "" : "; ", entry.name, entry.about,
                            entry.phantoms ? fmt::format(" ({})", entry.phantoms) : "");
    return text;
}

const StudyEntry& entry_named(const std::string& name) {
    const auto& entries = study_registry();
    return *std::find_if(entries.begin(), entries.end(),
                         [&](const StudyEntry& entry) { return entry.name == name; });
}

std::vector<Option> run_options() {
    return {
        Option::choice("study", study_names(), what_each_asks()).positional().required(),
        Option::folder("out", "Folder; one that holds rows of the same study is continued")
            .required(),
        Option::flag("overwrite", "Begin again"),
        Option::integer("jobs", 1, 256, "Cases that run at the same time").usually(std::int64_t{1}),
    };
}

std::vector<Option> phantom_options() {
    const StudyOptions usual;
    return {
        Option::integer("first_seed", 0, 4294967295.0, "Of the phantoms")
            .usually(std::int64_t{usual.first_seed}),
        Option::integer("phantoms", 1, 100000,
                        "How many anatomies, or other cases; default: the number beside the study"),
        Option::number("spacing", "mm", {0.3, 8}, "Voxel size")
            .list(3, 3)
            .usually(std::vector<double>{1, 1, 1}),
        Option::number("tangential", "", {0, 10},
                       "Factor on the walls' motion along themselves, of which the prior knows "
                       "nothing")
            .usually(usual.tangential),
        Option::integer("phantom_nodes", 1000, 2000000, "Of the meshes of the truths")
            .usually(std::int64_t{usual.phantom_nodes}),
        Option::choice("phantom_element", {"tet4", "tet10"},
                       "Of the meshes of the truths (exact-surfaces, neo-hookean: tet4)")
            .usually(element_table(usual.phantom_element).name),
        Option::choice(
            "load", {"mixed", "filling", "bump", "normal", "tangential", "shift", "large", "drawn"},
            "How the walls move; drawn: any but mixed for each phantom")
            .usually(std::string("mixed")),
        Option::choice("anatomy", {"usual", "round", "flat", "touching", "cut", "drawn"},
                       "Kind of organs; drawn: any but usual for each phantom")
            .usually(std::string("usual")),
        Option::text("contours",
                     "How both volumes are drawn: exact, or STYLE:SD:LENGTH in mm, STYLE one of "
                     "exponential, matern32, squared, slices; or drawn:SD, one of them and 4 to "
                     "12 mm for each phantom")
            .usually(std::string("exact")),
    };
}

/// Throws Error(invalid_argument) for an option that the study makes no use of.
void check_use(const StudyEntry& entry, const OptionValues& values) {
    const auto refuse = [&](const std::string& name) {
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("the study {} makes no use of {}; leave it out", entry.name,
                                command_line_name(name)));
    };
    const auto is_of_cases = [](const std::string& name) {
        return name == "first_seed" || name == "phantoms";
    };
    if (entry.phantoms == 0 || entry.counts_cases)
        for (const auto& part : {phantom_options(), mesher_options()})
            for (const Option& option : part)
                if (option.name != "mesh_program" && values.is_given(option.name) &&
                    !(entry.counts_cases && is_of_cases(option.name)))
                    refuse(option.name);
    if (!entry.has_images && values.is_given("contours")) refuse("contours");
}

StudyOptions study_options_of(const StudyEntry& entry, const OptionValues& values) {
    StudyOptions options;
    options.first_seed = static_cast<unsigned>(values.whole("first_seed"));
    options.phantoms = values.is_given("phantoms") ? values.integer("phantoms") : entry.phantoms;
    options.phantom_nodes = static_cast<Index>(values.integer("phantom_nodes"));
    options.phantom_element = recovery_element_of(values.text("phantom_element"));
    options.spacing = Vec3::Map(values.numbers("spacing").data());
    options.contours = contour_error_of(values.text("contours"));
    options.load = load_family_of(values.text("load"));
    options.anatomy = anatomy_family_of(values.text("anatomy"));
    options.tangential = values.number("tangential");
    options.mesher = mesher_of(values);
    options.solver = solver_of(values);
    return options;
}

std::string summary_text(const StudyReport& report, const StudyRun& run,
                         const std::string& folder) {
    std::string text = report.text;
    for (const auto& [id, message] : run.failures)
        text += fmt::format("{} failed: {}\n", id, message);
    if (run.is_cancelled)
        text += fmt::format("stopped after {} of {} cases; the same command goes on\n",
                            run.rows.size(), run.num_cases);
    return text + fmt::format("page: {}/study.html\n", folder);
}

ResultTree study_tree(const Study& study, const StudyReport& report, const StudyRun& run) {
    ResultTree tree = ResultTree::of("study", {{"format", "palpate-study"},
                                               {"format_version", 1},
                                               {"study", study.name},
                                               {"headline", report.headline},
                                               {"cases", std::int64_t(run.num_cases)},
                                               {"done", std::int64_t(run.rows.size())}});
    ResultTree& facts = tree.add_part("facts");
    for (const auto& [name, value] : report.facts) facts.add(name, value);
    ResultTree& failures = tree.add_part("failures", ResultTree::Shape::list);
    for (const auto& [id, message] : run.failures)
        failures.add(ResultTree::of(id, {{"case", id}, {"message", message}}));
    return tree;
}

Outcome run_study_application(const OptionValues& values, const ProgressSink& progress) {
    const StudyEntry& entry = entry_named(values.text("study"));
    check_use(entry, values);
    StudyRunOptions running;
    running.folder = values.path("out");
    running.overwrite = values.flag("overwrite");
    running.jobs = values.integer("jobs");
    running.is_cancelled = is_interrupted;
    will_write(running.folder / "pictures" / "any");
    const Study study = entry.make(study_options_of(entry, values));
    const StudyRun run = run_study(study, running, progress);
    write_study_page(study, run, running.folder);
    if (run.stopped_by && !is_interrupted()) std::rethrow_exception(run.stopped_by);
    const StudyReport report = run.rows.empty() ? StudyReport{} : study.report(run.rows);
    Outcome outcome{study_tree(study, report, run), summary_text(report, run, values.text("out"))};
    if (run.is_cancelled)
        outcome.exit_code = exit_code_of(ErrorCode::cancelled);
    else if (!run.failures.empty())
        outcome.exit_code = exit_code_not_converged;
    return outcome;
}

}  // namespace

Application study_application() {
    return {"study", "Recover many phantoms with known answers and judge the errors",
            joined({run_options(), phantom_options(), mesher_options(), solver_options()}),
            run_study_application};
}

}  // namespace palpate
