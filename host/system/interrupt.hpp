// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "solver/base/error.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// Ends the program in good order at Ctrl-C (SIGINT) and SIGTERM: progress sinks throw
/// Error(cancelled), which unwinds the work. What has not come to an end a good second later, or at
/// a second signal, is ended from outside, after its unfinished files have been removed: whatever
/// runs, the program is gone within two seconds, with exit code 9 and nothing half-written.
/// A signal that was ignored when the program started (nohup, &) stays ignored.
/// `program` is the name that the last words begin with.
/// To be called once, before any other thread starts. Temporary folders are kept in one folder from
/// here on, which is removed at the end, and those of programs that were killed with it.
void catch_interrupts(const std::string& program);

/// As `catch_interrupts` was told it.
const std::string& program_name();

bool is_interrupted();

/// Throws Error(cancelled) once a signal has come.
void throw_if_interrupted();

/// Outputs of this run appear at `path` or in it: of the folders that are missing on the way, and
/// of `path` itself, empty ones are removed when the program is ended from outside.
void will_write(const std::filesystem::path& path);

/// To be called before the program says its last words, which are said once, and ends with `code`.
/// Does not come back if the program is being ended from outside already.
void begin_to_end(int code);

/// Ends the program from another thread, with this reason as its last words and exit code, after
/// its unfinished files have been removed. If the program has begun to end by itself, it gets the
/// time for that first, and keeps its words and code.
[[noreturn]] void end_from_outside(const Error& reason);

/// `sink`, and a throw at every report after a signal.
ProgressSink interruptible(ProgressSink sink);

}  // namespace palpate
