// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

struct ChildLimits {
    double seconds = 120;   ///< wall clock and processor time
    double memory_gib = 8;  ///< address space
};

struct ChildResult {
    int exit_code = -1;      ///< -1 if a signal ended it
    int signal = 0;          ///< 0 if it exited by itself
    bool timed_out = false;  ///< a limit of time ended it
    std::string output;      ///< stdout, at most 64 KiB
    std::string errors;      ///< stderr, at most 64 KiB
    double seconds = 0;

    bool ok() const { return exit_code == 0 && !timed_out; }
};

/// Runs a program (no shell) and waits. The child gets no input, no other open file, no core dump,
/// the limits, and dies with the parent. `tick` is called about ten times a second; if it throws,
/// the child is killed first.
/// Throws Error(unsupported) if the program cannot be started.
ChildResult run_child(const std::filesystem::path& program,
                      const std::vector<std::string>& arguments, const ChildLimits& limits,
                      const std::function<void(double seconds)>& tick = {});

}  // namespace palpate
