// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate::bench {

struct ProgramRun {
    int exit_code;           ///< 128 and the signal if one ended it
    double processor_s;      ///< of the program and its children, user and system
    double peak_memory_mib;  ///< of the largest of them
};

/// Runs `command` (program and arguments) to its end, its standard output thrown away.
/// Throws Error(internal) if it cannot be started.
ProgramRun run_program(const std::vector<std::string>& command);

/// The program `palpate` to measure: PALPATE_PROGRAM, or the one beside this executable.
std::string palpate_program();

}  // namespace palpate::bench
