// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/interrupt.hpp"

#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "host/system/scratch.hpp"
#include "solver/base/error.hpp"
#include "solver/base/locked_folder.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr int patience_ms = 1300;      // for the work to unwind
constexpr int last_patience_ms = 600;  // for the exit handlers of libraries
constexpr const char* interrupted =
    "stopped by a signal (Ctrl-C or SIGTERM); nothing half-written is left";

// A signal handler has no other way to be told anything: all state of this file.
std::atomic<int> num_signals{0};
int wake_up[2] = {-1, -1};        // a pipe from the handler to the thread that watches
std::atomic<int> ending_code{0};  // with which the program ends, once it has begun to; 0: not yet
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler sets it");

/// Folders that the program will make, innermost first.
std::mutex missing_mutex;
std::vector<fs::path>& missing_folders() {
    static auto* all = new std::vector<fs::path>;  // the thread that watches outlives main
    return *all;
}

std::string& told_name() {
    static auto* name = new std::string("palpate");
    return *name;
}

void on_signal(int) {
    const int kept = errno;
    ++num_signals;
    const ssize_t ignored = write(wake_up[1], "x", 1);
    (void)ignored;
    errno = kept;
}

/// Waits for a signal, or for so many milliseconds (-1: for ever).
void wait_for_signal(int milliseconds) {
    pollfd end{wake_up[0], POLLIN, 0};
    char byte = 0;
    while (poll(&end, 1, milliseconds) < 0 && errno == EINTR) {
    }
    if (end.revents & POLLIN) {
        const ssize_t ignored = read(wake_up[0], &byte, 1);
        (void)ignored;
    }
}

void remove_empty_outputs() {
    const std::lock_guard lock(missing_mutex);
    for (const fs::path& folder : missing_folders()) rmdir(folder.c_str());  // only if empty
}

bool is_first_to_end(int code) {
    int none = 0;
    return ending_code.compare_exchange_strong(none, code);
}

void hold_still(int) {
    for (;;) pause();
}

/// A driver that misses its files aborts: that must not decide how the program ends.
void hold_threads_that_abort() { std::signal(SIGABRT, hold_still); }

void watch() {
    wait_for_signal(-1);
    wait_for_signal(patience_ms);
    end_from_outside(Error(ErrorCode::cancelled, interrupted));
}

void catch_one(int signal) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) return;
    action = {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
}

}  // namespace

void catch_interrupts(const std::string& program) {
    told_name() = program;
    make_scratch();
    if (pipe(wake_up) != 0) return;  // signals then end the program as the system does
    std::thread(watch).detach();
    catch_one(SIGINT);
    catch_one(SIGTERM);
}

const std::string& program_name() { return told_name(); }

bool is_interrupted() { return num_signals > 0; }

void throw_if_interrupted() {
    if (is_interrupted()) throw Error(ErrorCode::cancelled, interrupted);
}

void will_write(const fs::path& path) {
    if (path.empty()) return;
    std::error_code failed;
    fs::path folder = fs::absolute(path, failed).lexically_normal();
    if (!folder.has_filename()) folder = folder.parent_path();
    const std::lock_guard lock(missing_mutex);
    for (; !failed && !fs::exists(folder, failed); folder = folder.parent_path())
        missing_folders().push_back(folder);
}

void begin_to_end(int code) {
    if (!is_first_to_end(code)) hold_still(0);
}

void end_from_outside(const Error& reason) {
    const bool is_first = is_first_to_end(exit_code_of(reason.code()));
    if (!is_first) usleep(last_patience_ms * 1000);
    hold_threads_that_abort();
    remove_folders_in_progress();
    remove_empty_outputs();
    const std::string sentence = program_name() + ": " + reason.what() + "\n";
    const ssize_t ignored = is_first ? write(STDERR_FILENO, sentence.data(), sentence.size()) : 0;
    (void)ignored;
    _exit(ending_code);
}

ProgressSink interruptible(ProgressSink sink) {
    return [sink = std::move(sink)](const Progress& progress) {
        throw_if_interrupted();
        if (sink && !progress.stage.empty()) sink(progress);
    };
}

}  // namespace palpate
