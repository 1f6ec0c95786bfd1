// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "host/cohort/supervised_child.hpp"

namespace palpate {

/// Whether a failure of that code, told by the process of a patient, may be the machine's: a back
/// end, a mesher or a library that does not work there. What is wrong with inputs is not.
bool may_be_of_machine(int code);

/// Tells a bad case from a bad machine: when something ended that may be either's fault, the tiny
/// phantom is tried in a process of its own. Trials are numbered from 1; trial 0 is passed.
class MachineTrial {
public:
    /// At most so many seconds a trial.
    MachineTrial(std::filesystem::path program, std::filesystem::path cohort, double limit_s);

    /// A trial that begins from now on; its number.
    std::size_t ask();
    /// Begins what was asked for, looks at what runs. Call it often.
    void watch();
    /// Asks the process to end: the runner stops.
    void stop() const;
    bool is_passed(std::size_t trial) const { return trial <= passed_; }
    /// In words, once two trials in a row have failed. Those that were ended from outside, or could
    /// not read or write, say nothing: after three of them, some seconds apart, the machine counts
    /// as good.
    const std::optional<std::string>& failure() const { return failure_; }

private:
    using Clock = std::chrono::steady_clock;
    std::string why_failed(const ChildEnd& end) const;

    std::filesystem::path program_, cohort_;
    double limit_s_;
    std::unique_ptr<SupervisedChild> child_;
    Clock::time_point begin_ = {}, not_before_ = {};
    bool is_late_ = false, has_failed_once_ = false;
    std::size_t asked_ = 0, begun_ = 0, passed_ = 0;
    int num_without_word_ = 0;
    std::optional<std::string> failure_;
};

}  // namespace palpate
