// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/patient_in_work.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double seconds_to_unwind = 2, seconds_between_looks = 0.25;

double seconds_since(PatientInWork::Clock::time_point then) {
    return std::chrono::duration<double>(PatientInWork::Clock::now() - then).count();
}

}  // namespace

void PatientInWork::begin_watch(double limit_of_process_s, const std::vector<std::string>& cases) {
    current.clear();
    passed_limit.clear();
    passed_memory = false;
    has_ended = false;
    faults.clear();
    trial = 0;
    limit_s = limit_of_process_s;
    unreported = {cases.begin(), cases.end()};
    last_event = Clock::now();
}

void PatientInWork::end_beyond_limits(double most_mb) {
    if (seconds_since(last_look) < seconds_between_looks) return;
    last_look = Clock::now();
    if (!passed_limit.empty()) {
        if (seconds_since(asked_to_end) > seconds_to_unwind) child->signal_group(SIGKILL);
    } else if (seconds_since(last_event) > limit_s) {
        passed_limit = fmt::format("it took longer than {:g} s", limit_s);
        asked_to_end = Clock::now();
        child->signal_group(SIGTERM);
    } else if (child->holds_more_than(most_mb)) {
        passed_limit = fmt::format("it needed more than {:g} MB of memory", most_mb);
        passed_memory = true;
        child->signal_group(SIGKILL);  // before the machine does so to another
    }
}

CaseFault PatientInWork::unsaid_fault(const ChildEnd& end) const {
    if (!passed_limit.empty()) return {current, exit_code_of(ErrorCode::time_limit), passed_limit};
    std::string why = fmt::format("its process ended with exit code {}", end.exit_code);
    if (end.exit_code == 0) why = "its process ended well and left no result";
    if (end.signal != 0)
        why = fmt::format("its process was ended by signal {} ({})", end.signal,
                          ::strsignal(end.signal));
    return {current, end.exit_code > 0 ? end.exit_code : exit_code_of(ErrorCode::internal), why};
}

bool PatientInWork::may_be_of_machine(const ChildEnd& end) const {
    if (!passed_limit.empty()) return !passed_memory;
    return end.signal != SIGKILL;
}

void PatientInWork::append_log_to(const std::filesystem::path& file) const {
    const std::string& log = child->log_tail();
    if (log.empty()) return;
    const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (out < 0) return;
    const ssize_t ignored = ::write(out, log.data(), log.size());
    (void)ignored;
    ::close(out);
}

}  // namespace palpate
