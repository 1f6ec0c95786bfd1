// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/child_program.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <optional>

#include "host/system/child_process.hpp"

namespace palpate {

namespace {

constexpr std::size_t max_text = 64 * 1024;
constexpr int tick_ms = 100;
constexpr double seconds_after_kill = 2;

/// Takes what can be read. Text beyond the limit is thrown away.
void take_text(TextPipe& pipe, std::string& text) {
    std::string more;
    pipe.drain(more);
    text.append(more, 0, max_text - std::min(max_text, text.size()));
}

void wait_for_text(ChildProcess& child, ChildResult& result) {
    std::array<pollfd, 2> ends{pollfd{child.output().descriptor(), POLLIN, 0},
                               pollfd{child.errors().descriptor(), POLLIN, 0}};
    if (poll(ends.data(), ends.size(), tick_ms) <= 0) return;
    if (ends[0].revents) take_text(child.output(), result.output);
    if (ends[1].revents) take_text(child.errors(), result.errors);
}

}  // namespace

ChildResult run_child(const std::filesystem::path& program,
                      const std::vector<std::string>& arguments, const ChildLimits& limits,
                      const std::function<void(double)>& tick) {
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    ChildProcess child(program, arguments, {limits.seconds, limits.memory_gib});
    ChildResult result;
    while (child.output().descriptor() >= 0 || child.errors().descriptor() >= 0) {
        wait_for_text(child, result);
        const double now = elapsed();
        if (!result.timed_out && now > limits.seconds) {
            result.timed_out = true;
            child.signal_group(SIGKILL);
        }
        if (now > limits.seconds + seconds_after_kill) break;  // a grandchild holds the pipe
        if (tick && !result.timed_out) tick(now);
    }
    std::optional<ChildEnd> end;
    while (!(end = child.ended())) {
        if (elapsed() > limits.seconds) {
            result.timed_out = true;
            child.signal_group(SIGKILL);
        }
        usleep(1000);
    }
    result.seconds = elapsed();
    result.exit_code = end->exit_code;
    result.signal = end->signal;
    if (result.signal == SIGXCPU) result.timed_out = true;
    return result;
}

}  // namespace palpate
