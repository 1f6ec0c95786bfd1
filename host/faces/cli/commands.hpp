// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace palpate {

struct Application;

/// What a command returns when its arguments were parsed: the process exit code.
using Run = std::function<int()>;

/// Each adds one sub-command with its options to `app` and sets `run` when it is the one chosen.
void add_warp(CLI::App& app, Run& run);
void add_export(CLI::App& app, Run& run);
void add_cohort(CLI::App& app, Run& run);
void add_devices(CLI::App& app, Run& run);
void add_describe(CLI::App& app, Run& run);
/// The command of an application, which outlives the parsing, made from its table.
void add_application(CLI::App& app, const Application& application, Run& run);

}  // namespace palpate
