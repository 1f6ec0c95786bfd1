// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>

#include "host/apps/all.hpp"
#include "host/apps/describe.hpp"
#include "host/faces/cli/commands.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

struct DescribeArguments {
    std::string application, form = "markdown";
};

int run_describe(const DescribeArguments& arguments) {
    const std::string& name = arguments.application;
    const auto chosen = name.empty() ? applications() : std::vector{application_named(name)};
    if (arguments.form == "boutiques") {
        if (name.empty())
            throw Error(ErrorCode::invalid_argument,
                        "a Boutiques descriptor is of one application; name it");
        fmt::print("{}", boutiques_json(chosen.front()));
    } else {
        fmt::print("{}", arguments.form == "json" ? applications_json(chosen)
                                                  : applications_markdown(chosen));
    }
    return 0;
}

}  // namespace

void add_describe(CLI::App& app, Run& run) {
    auto arguments = std::make_shared<DescribeArguments>();
    CLI::App* command =
        app.add_subcommand("describe", "Tell what applications take, for people and programs");
    command->add_option("application", arguments->application, "One of them; default: all");
    command->add_option("--as", arguments->form, "Tables, JSON, or a descriptor for Boutiques")
        ->check(CLI::IsMember({"markdown", "json", "boutiques"}))
        ->capture_default_str();
    command->callback(
        [arguments, &run] { run = [arguments] { return run_describe(*arguments); }; });
}

}  // namespace palpate
