// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/time_limit.hpp"

#include <fmt/core.h>

#include <utility>

#include "host/system/interrupt.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds patience(1);  // after the limit, for a clean end

}  // namespace

TimeLimit::TimeLimit(double seconds, LimitEnds ends) : seconds_(seconds) {
    if (seconds_ > 0 && ends == LimitEnds::program)
        watchdog_ = std::thread([this] { wait_and_end(); });
}

TimeLimit::~TimeLimit() {
    {
        const std::lock_guard lock(mutex_);
        is_over_ = true;
    }
    over_.notify_all();
    if (watchdog_.joinable()) watchdog_.join();
}

std::string TimeLimit::sentence() const {
    return fmt::format("the time limit of {:g} s is over; raise it, or take fewer nodes", seconds_);
}

ProgressSink TimeLimit::watched(ProgressSink inner) const {
    if (seconds_ <= 0) return inner;
    return [this, inner = std::move(inner)](const Progress& progress) {
        if (std::chrono::duration<double>(Clock::now() - begin_).count() > seconds_)
            throw Error(ErrorCode::time_limit, sentence());
        if (inner) inner(progress);
    };
}

void TimeLimit::wait_and_end() {
    std::unique_lock lock(mutex_);
    const auto end =
        begin_ +
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds_)) +
        patience;
    if (over_.wait_until(lock, end, [this] { return is_over_; })) return;
    end_from_outside(Error(ErrorCode::time_limit, sentence()));
}

}  // namespace palpate
