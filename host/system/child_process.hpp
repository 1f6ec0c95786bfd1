// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

struct ChildSetup {
    double processor_s = 0, memory_gib = 0;  ///< limits, of address space the second; 0: none
    int inherited = -1;                      ///< an open file that it gets as its third; -1: none
};

/// How a child ended.
struct ChildEnd {
    int exit_code = -1;  ///< -1 if a signal ended it
    int signal = 0;      ///< 0 if it exited by itself
};

/// The end of a pipe from which text is taken without waiting.
class TextPipe {
public:
    explicit TextPipe(int descriptor) : descriptor_(descriptor) {}
    ~TextPipe() { close(); }
    TextPipe(const TextPipe&) = delete;
    TextPipe& operator=(const TextPipe&) = delete;

    int descriptor() const { return descriptor_; }  ///< to poll; -1 at its end
    /// Appends what is there, at most some 64 KiB at a time if more keeps coming.
    void drain(std::string& text);

private:
    void close();
    int descriptor_;
};

/// A program (no shell) in a process group of its own. It gets no input, no open file but its two
/// outputs and `inherited`, no core dump, and dies with the thread that made it. The destructor
/// kills and reaps the group.
class ChildProcess {
public:
    /// Returns when the program runs. Throws Error(unsupported) if it cannot be started,
    /// Error(out_of_memory) if there can be no process, Error(internal) without pipes.
    ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                 const ChildSetup& setup);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    TextPipe& output() { return *output_; }
    TextPipe& errors() { return *errors_; }
    const TextPipe& output() const { return *output_; }
    const TextPipe& errors() const { return *errors_; }
    /// Empty while it runs, and after it was told once. What it has left behind is killed.
    std::optional<ChildEnd> ended();
    void signal_group(int signal) const;
    pid_t id() const { return id_; }  ///< -1 once it was told to have ended

private:
    pid_t id_ = -1;
    std::optional<TextPipe> output_, errors_;
};

}  // namespace palpate
