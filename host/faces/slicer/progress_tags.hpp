// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

#include "solver/base/log.hpp"

namespace palpate {

/// Progress as a host of modules reads it: tags on lines of standard output, flushed one by one.
/// The fraction is that of the whole run and never goes back.
class ProgressTags {
public:
    explicit ProgressTags(std::FILE* out) : out_(out) {}
    void start(const std::string& name, const std::string& comment);
    void tell(const Progress& progress);
    /// Tells 1 and ends.
    void end();

private:
    void print(const std::string& line);
    void advance(double fraction);

    std::FILE* out_;
    double fraction_ = 0;
    double begin_ = 0, end_ = 0;  ///< of the stage that is going on
    std::string name_, stage_;
    std::chrono::steady_clock::time_point started_;
};

}  // namespace palpate
