// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include "host/apps/all.hpp"
#include "host/cohort/content_key.hpp"
#include "host/faces/cli/commands.hpp"
#include "host/faces/cli/console.hpp"
#include "host/system/blas_kernels.hpp"
#include "host/system/exit_codes.hpp"
#include "host/system/memory_limit.hpp"
#include "host/system/run_program.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace {

std::string names_of(const std::vector<const CLI::App*>& commands) {
    std::string names;
    for (const CLI::App* command : commands)
        names += (names.empty() ? "" : ", ") + command->get_name();
    return names;
}

/// What is wrong with the command, which CLI11 only calls missing; else what it says, with choices
/// in the words that are allowed.
std::string complaint(const CLI::App& app, const std::vector<std::string>& words,
                      const std::string& said) {
    const CLI::App* command = &app;
    const auto all = [](const CLI::App*) { return true; };
    for (const std::string& word : words) {
        const auto below = command->get_subcommands(all);
        if (below.empty() || word.starts_with('-')) break;
        const auto found = std::find_if(below.begin(), below.end(), [&](const CLI::App* one) {
            return one->get_name() == word;
        });
        if (found == below.end())
            return fmt::format("there is no command '{}'; there are {}", word, names_of(below));
        command = *found;
    }
    const std::regex choice(R"(Check (.*) value in \{(.*)\} OR \{.*\} FAILED)");
    const std::regex number(R"(->\d+)");
    std::smatch parts;
    if (!std::regex_search(said, parts, choice)) return said;
    return parts.prefix().str() + parts[1].str() + " not in {" +
           std::regex_replace(parts[2].str(), number, "") + "}";
}

/// In lines of a terminal.
std::string exit_codes_text() {
    constexpr std::size_t width = 90;
    std::string text, line = "Exit codes:";
    for (const auto& [code, meaning] : palpate::exit_codes()) {
        const std::string entry = fmt::format(" {} {},", code, meaning);
        if (line.size() + entry.size() > width) {
            text += line + '\n';
            line.clear();
        }
        line += line.empty() ? entry.substr(1) : entry;
    }
    line.back() = '.';
    return text + line;
}

int parse_and_run(int argc, char** argv) {
    CLI::App app{
        "Computational palpation: stiffness, forces and deformation from two segmentations"};
    app.name("palpate");
    app.set_version_flag(
        "--version",
        fmt::format("palpate {}\nnumerics {}: equal numbers, equal answers\n{}",
                    palpate::version_text(), palpate::numerics_version, palpate::build_text()));
    app.require_subcommand(1);
    app.footer(exit_codes_text() + "\nNot a medical device.");
    palpate::Run run;
    for (const palpate::Application& application : palpate::applications())
        palpate::add_application(app, application, run);
    palpate::add_cohort(app, run);
    palpate::add_warp(app, run);
    palpate::add_export(app, run);
    palpate::add_devices(app, run);
    palpate::add_describe(app, run);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        throw palpate::Error(palpate::ErrorCode::invalid_argument,
                             fmt::format("{}; see `palpate --help`",
                                         complaint(app, {argv + 1, argv + argc}, error.what())));
    }
    palpate::prepare_for_memory_limit();
    return run();
}

}  // namespace

int main(int argc, char** argv) {
    palpate::take_fast_blas_kernels(argv);
    palpate::run_program(
        "palpate", [&] { return parse_and_run(argc, argv); }, palpate::end_progress_line);
}
