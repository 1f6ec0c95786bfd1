// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/machine_trial.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstring>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds seconds_between_trials{3};
constexpr int most_without_word = 3;

/// The last line that is not empty.
std::string last_line(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    return text.substr(text.rfind('\n') + 1);
}

/// Ended from outside, or by what it reads and writes: nothing of the machine's own.
bool says_nothing(const ChildEnd& end) {
    if (end.signal != 0)
        return end.signal == SIGKILL || end.signal == SIGTERM || end.signal == SIGINT;
    for (const ErrorCode code :
         {ErrorCode::invalid_argument, ErrorCode::input_unreadable, ErrorCode::input_unusable,
          ErrorCode::time_limit, ErrorCode::output_failed})
        if (end.exit_code == exit_code_of(code)) return true;
    return false;
}

}  // namespace

bool may_be_of_machine(int code) {
    return code == exit_code_of(ErrorCode::internal) ||
           code == exit_code_of(ErrorCode::mesh_failed) ||
           code == exit_code_of(ErrorCode::solve_failed) ||
           code == exit_code_of(ErrorCode::device_failed);
}

MachineTrial::MachineTrial(std::filesystem::path program, std::filesystem::path cohort,
                           double limit_s)
    : program_(std::move(program)), cohort_(std::move(cohort)), limit_s_(limit_s) {}

std::size_t MachineTrial::ask() {
    asked_ = begun_ + 1;
    return asked_;
}

void MachineTrial::watch() {
    if (failure_) return;
    if (!child_) {
        if (passed_ == asked_ || Clock::now() < not_before_) return;
        begun_ = asked_;
        begin_ = Clock::now();
        is_late_ = false;
        child_ = std::make_unique<SupervisedChild>(
            program_, std::vector<std::string>{"cohort", "trial", cohort_.string()}, -1);
        return;
    }
    child_->read([](const std::string&) {});
    if (Clock::now() - begin_ > std::chrono::duration<double>(limit_s_)) {
        is_late_ = true;
        child_->signal_group(SIGKILL);
    }
    const auto end = child_->ended();
    if (!end) return;
    child_->read([](const std::string&) {});
    if (end->exit_code == 0) {
        passed_ = begun_;
        has_failed_once_ = false;
        num_without_word_ = 0;
    } else if (!is_late_ && says_nothing(*end)) {
        not_before_ = Clock::now() + seconds_between_trials;
        if (++num_without_word_ == most_without_word) {
            passed_ = begun_;
            num_without_word_ = 0;
        }
    } else if (std::exchange(has_failed_once_, true)) {
        failure_ = why_failed(*end);
    }
    child_.reset();
}

void MachineTrial::stop() const {
    if (child_) child_->signal_group(SIGTERM);
}

std::string MachineTrial::why_failed(const ChildEnd& end) const {
    if (is_late_) return fmt::format("it took longer than {:g} s", limit_s_);
    if (end.signal != 0)
        return fmt::format("its process was ended by signal {} ({})", end.signal,
                           ::strsignal(end.signal));
    const std::string said = last_line(child_->log_tail());
    return said.empty() ? fmt::format("its process ended with exit code {}", end.exit_code) : said;
}

}  // namespace palpate
