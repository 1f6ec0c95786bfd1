// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/cli/console.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "host/system/interrupt.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

bool& line_is_open() {
    static bool open = false;
    return open;
}

std::size_t terminal_width() {
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20;
    return known ? size.ws_col : 100;
}

std::string bar(double fraction) {
    constexpr int width = 20;
    const int filled = static_cast<int>(width * std::clamp(fraction, 0.0, 1.0));
    return fmt::format("[{:<{}}]", std::string(filled, '='), width);
}

struct Console {
    Clock::time_point begin = Clock::now();
    std::string stage;
    double next_line_s = 0;

    double elapsed_s() const { return std::chrono::duration<double>(Clock::now() - begin).count(); }

    void rewrite(const Progress& progress) {
        if (progress.stage != stage) end_progress_line();
        stage = progress.stage;
        std::string line = fmt::format("{:6.1f} s  {:<11}", elapsed_s(), progress.stage);
        if (progress.fraction > 0 && progress.fraction < 1) line += bar(progress.fraction) + " ";
        line += progress.message;
        line.resize(std::min(line.size(), terminal_width() - 1));
        fmt::print(stderr, "\r\x1b[K{}", line);
        std::fflush(stderr);
        line_is_open() = true;
    }

    void append(const Progress& progress) {
        const bool is_new = progress.stage != stage || progress.stage == "searching";
        if (progress.message.empty() || (!is_new && elapsed_s() < next_line_s)) return;
        stage = progress.stage;
        next_line_s = elapsed_s() + 5.0;
        fmt::print(stderr, "{:6.1f} s  {:<11} {}\n", elapsed_s(), progress.stage, progress.message);
    }
};

}  // namespace

void end_progress_line() {
    if (!line_is_open()) return;
    fmt::print(stderr, "\n");
    line_is_open() = false;
}

ProgressSink console_progress(bool quiet) {
    if (quiet) return interruptible({});
    auto console = std::make_shared<Console>();
    if (isatty(STDERR_FILENO)) {
        return interruptible([console](const Progress& progress) { console->rewrite(progress); });
    }
    return interruptible([console](const Progress& progress) { console->append(progress); });
}

}  // namespace palpate
