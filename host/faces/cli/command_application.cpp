// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "host/apps/application.hpp"
#include "host/faces/cli/commands.hpp"
#include "host/faces/cli/console.hpp"
#include "host/page/tree_text.hpp"
#include "host/system/interrupt.hpp"

namespace palpate {
namespace {

struct ApplicationArguments {
    OptionWords words;
    bool quiet = false;
};

int run_command(const Application& application, const ApplicationArguments& arguments) {
    const auto values = OptionValues::from_words(all_options(application), arguments.words);
    for (const Option& option : all_options(application))
        if (option.makes_path()) will_write(values.path(option.name));
    const Outcome outcome =
        run_application(application, values, LimitEnds::program, console_progress(arguments.quiet));
    end_progress_line();
    fmt::print("{}", outcome.text.empty() ? tree_text(outcome.result) : outcome.text);
    if (!application.writes_its_folder() && values.is_given("out"))
        fmt::print("report: {}/report.html\n", values.text("out"));
    return outcome.exit_code;
}

/// What stands behind the name in the help.
std::string value_text(const Option& option) {
    if (option.kind == OptionKind::choice)
        return fmt::format("{{{}}}", fmt::join(option.choices, ","));
    std::string text = option.kind == OptionKind::integer  ? "INTEGER"
                       : option.kind == OptionKind::number ? "NUMBER"
                       : option.kind == OptionKind::text   ? "TEXT"
                       : option.kind == OptionKind::folder ? "FOLDER"
                                                           : "FILE";
    if (!option.unit.empty()) text += fmt::format(" {}", option.unit);
    const bool is_bounded =
        option.range.low > any_number.low && option.range.high < any_number.high;
    if (option.is_number() && is_bounded)
        text += fmt::format(" in {}{} - {}]", option.range.open_low ? "(" : "[", option.range.low,
                            option.range.high);
    return text;
}

std::string usual_words(const Option& option) {
    if (!option.usual) return "";
    const auto* text = std::get_if<std::string>(&*option.usual);
    return text ? *text : setting_text(*option.usual);
}

/// What is allowed is judged by the table, not by CLI11. `option` speaks as a command line does.
void add(CLI::App& command, const Option& option, OptionWords& words) {
    const std::string name = option.is_positional ? option.name : command_line_name(option.name);
    if (option.kind == OptionKind::flag) {
        command.add_flag_function(
            name,
            [&words, id = option.name](std::int64_t times) {
                if (times > 0) words[id] = {};  // not --flag=false
            },
            option.meaning);
        return;
    }
    CLI::Option* added = command.add_option(
        name,
        [&words, id = option.name](const CLI::results_t& given) {
            words[id] = given;
            return true;
        },
        option.meaning);
    added->type_name(value_text(option))->default_str(usual_words(option));
    if (option.is_required) added->required();
    if (!option.is_list()) return;
    if (option.least == option.most)
        added->expected(static_cast<int>(option.least));
    else
        added->expected(1, CLI::detail::expected_max_vector_size)
            ->allow_extra_args(!option.is_repeated());
}

}  // namespace

void add_application(CLI::App& app, const Application& application, Run& run) {
    auto arguments = std::make_shared<ApplicationArguments>();
    CLI::App* command = app.add_subcommand(application.name, application.summary);
    const std::vector<Option> table = all_options(application);
    for (Option option : table) {
        option.meaning = as_commands_spell(table, option.meaning);
        add(*command, option, arguments->words);
    }
    command->add_flag("--quiet", arguments->quiet, "No progress");
    command->callback([arguments, &application, &run] {
        run = [arguments, &application] { return run_command(application, *arguments); };
    });
}

}  // namespace palpate
