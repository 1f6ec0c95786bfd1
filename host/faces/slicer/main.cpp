// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// palpate as a command line module of 3D Slicer: progress and log on standard output, standard
// error for what went wrong only, any exit code but 0 means that no output is loaded.
#include <fmt/core.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "host/apps/recover/report/result_folder.hpp"
#include "host/apps/recover/report/text_report.hpp"
#include "host/faces/slicer/progress_tags.hpp"
#include "host/faces/slicer/recover_module.hpp"
#include "host/faces/slicer/table_parameters.hpp"
#include "host/io/files.hpp"
#include "host/io/output_folder.hpp"
#include "host/system/blas_kernels.hpp"
#include "host/system/interrupt.hpp"
#include "host/system/memory_limit.hpp"
#include "host/system/run_program.hpp"
#include "host/system/version.hpp"

namespace palpate {

std::string_view module_xml();

namespace {

/// The description with our version and the options of the method in it.
std::string description_text() {
    std::string text(module_xml());
    const auto fill = [&](const std::string& mark, const std::string& what) {
        text.replace(text.find(mark), mark.size(), what);
    };
    fill("@VERSION@", version_text());
    fill("@METHOD@", parameters_xml(method_options()));
    return text;
}

void write_return_parameters(const ModuleArguments& arguments, const std::string& text) {
    if (!arguments.return_parameter_file.empty())
        write_atomically(arguments.return_parameter_file,
                         [&](const auto& file) { write_text_file(file, text); });
}

/// A search that did not converge has outputs all the same: the summary says so.
void run_module(const ModuleArguments& arguments) {
    ProgressTags tags(stdout);
    const ProgressSink progress = interruptible([&](const Progress& step) { tags.tell(step); });
    tags.start("palpate", "stiffness from two segmentations");
    prepare_for_memory_limit();
    const RecoverOptions options = module_options(arguments);
    will_write(arguments.text("resultFolder"));
    const RecoveryResult result =
        recover(read_segmentation(arguments.text("reference")),
                read_segmentation(arguments.text("target")), options, progress);
    report_progress(progress, "writing", 0);
    write_module_outputs(arguments, result);
    write_return_parameters(arguments, return_parameters(result));
    fmt::print("{}\n", text_report(result));
    tags.end();
}

int parse_and_run(const std::vector<std::string>& words) {
    const std::string xml = description_text();
    const ModuleDescription module = parse_module_description(xml);
    const ModuleArguments arguments = parse_module_arguments(module, words);
    if (arguments.wants_xml) {
        std::fwrite(xml.data(), 1, xml.size(), stdout);
        return 0;
    }
    if (arguments.wants_help) return fmt::print("{}", help_text(module)), 0;
    if (arguments.wants_version) return fmt::print("palpate-slicer {}\n", version_text()), 0;
    if (arguments.wants_echo) fmt::print("{}", echo_text(module, arguments));
    if (!arguments.serialize_to.empty())
        write_atomically(arguments.serialize_to, [&](const auto& file) {
            write_text_file(file, to_json(module, arguments));
        });
    run_module(arguments);
    return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    palpate::take_fast_blas_kernels(argv);
    palpate::run_program("palpate-slicer", [&] {
        return palpate::parse_and_run({argv + 1, argv + argc});
    });
}
