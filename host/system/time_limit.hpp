// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "solver/base/log.hpp"

namespace palpate {

/// What may be ended when work takes too long.
enum class LimitEnds {
    work,     ///< only that: by Error(time_limit) at its next sign of progress
    program,  ///< a second after that the process, with the same sentence and exit code: a device
              ///< that hangs gives no sign
};

/// Ends work that takes too long. Nothing half-written stays: results get their names in one step.
class TimeLimit {
public:
    /// 0: none.
    explicit TimeLimit(double seconds, LimitEnds ends = LimitEnds::program);
    ~TimeLimit();
    TimeLimit(const TimeLimit&) = delete;
    TimeLimit& operator=(const TimeLimit&) = delete;

    /// `inner`, which may be empty, and the limit.
    ProgressSink watched(ProgressSink inner) const;

private:
    using Clock = std::chrono::steady_clock;
    std::string sentence() const;
    void wait_and_end();

    double seconds_;
    Clock::time_point begin_ = Clock::now();
    std::mutex mutex_;
    std::condition_variable over_;
    bool is_over_ = false;
    std::thread watchdog_;
};

}  // namespace palpate
