// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// How a child ended.
struct ChildEnd {
    int exit_code = -1;  ///< -1 if a signal ended it
    int signal = 0;
};

/// A process in a group of its own that is watched while others run: what it writes comes line by
/// line. It gets no input and no open file but `inherited`, and dies with the thread that made it.
/// To be made by the main thread only. The destructor kills and reaps the group.
class SupervisedChild {
public:
    /// Throws Error(internal) if there can be no such process.
    SupervisedChild(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                    int inherited);
    ~SupervisedChild();
    SupervisedChild(const SupervisedChild&) = delete;
    SupervisedChild& operator=(const SupervisedChild&) = delete;

    int output() const { return output_; }  ///< to poll; -1 at its end
    int errors() const { return errors_; }

    /// Takes what is there, without waiting; `line` gets every whole line of the output.
    void read(const std::function<void(const std::string& line)>& line);
    /// What it wrote to its standard error, the last 16 KiB.
    const std::string& log_tail() const { return log_; }
    /// Empty while it runs.
    std::optional<ChildEnd> ended();
    void signal_group(int signal) const;

private:
    void drain(int& end, std::string& text);

    pid_t id_ = -1;
    int output_ = -1, errors_ = -1;
    std::string lines_, log_;
};

}  // namespace palpate
