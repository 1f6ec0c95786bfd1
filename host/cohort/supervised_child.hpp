// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/system/child_process.hpp"
#include "host/system/resident_memory.hpp"

namespace palpate {

/// A process that is watched while others run: what it writes comes line by line. To be made by the
/// main thread only: it dies with the thread that made it.
class SupervisedChild {
public:
    /// Throws as `ChildProcess`.
    SupervisedChild(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                    int inherited)
        : process_(program, arguments, {0, 0, inherited}) {}

    int output() const { return process_.output().descriptor(); }  ///< to poll; -1 at its end
    int errors() const { return process_.errors().descriptor(); }

    /// Takes what is there, without waiting; `line` gets every whole line of the output.
    void read(const std::function<void(const std::string& line)>& line);
    /// What it wrote to its standard error, the last 16 KiB.
    const std::string& log_tail() const { return log_; }
    /// Empty while it runs.
    std::optional<ChildEnd> ended() { return process_.ended(); }
    void signal_group(int signal) const { process_.signal_group(signal); }
    /// Of it and of what it has started; 0 once it was told to have ended.
    bool holds_more_than(double mb) const {
        return process_.id() > 0 && palpate::holds_more_than(process_.id(), mb);
    }

private:
    ChildProcess process_;
    std::string lines_, log_;
};

}  // namespace palpate
