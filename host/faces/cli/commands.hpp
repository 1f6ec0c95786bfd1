// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace palpate {

/// What a command returns when its arguments were parsed: the process exit code.
using Run = std::function<int()>;

/// Each adds one sub-command with its options to `app` and sets `run` when it is the one chosen.
void add_recover(CLI::App& app, Run& run);
void add_phantom(CLI::App& app, Run& run);
void add_simulate(CLI::App& app, Run& run);
void add_study(CLI::App& app, Run& run);
void add_warp(CLI::App& app, Run& run);
void add_export(CLI::App& app, Run& run);
void add_devices(CLI::App& app, Run& run);

}  // namespace palpate
