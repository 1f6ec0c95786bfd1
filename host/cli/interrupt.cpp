// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cli/interrupt.hpp"

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

#include "host/cli/scratch.hpp"
#include "host/imaging/locked_folder.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr int patience_ms = 1300;  // for the work to unwind
constexpr const char* last_words =
    "stopped by a signal (Ctrl-C or SIGTERM); nothing half-written is left";

// A signal handler has no other way to be told anything: all state of this file.
std::atomic<int> num_signals{0};
int wake_up[2] = {-1, -1};  // a pipe from the handler to the thread that watches
std::atomic_flag is_ending = ATOMIC_FLAG_INIT;
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler sets it");

struct Output {
    fs::path path;
    std::vector<fs::path> missing_parents;  ///< that the program will make, innermost first
};
std::mutex outputs_mutex;
std::vector<Output>& outputs() {
    static auto* all = new std::vector<Output>;  // the thread that watches outlives main
    return *all;
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

/// Takes away the name first, so that no half of it can still get its final one.
void discard(const fs::path& path) {
    const fs::path aside = path.string() + "-cancelled";
    if (std::rename(path.c_str(), aside.c_str()) != 0) return;
    remove_persistently(aside);
}

void discard_unfinished_in(const fs::path& folder) {
    const std::string mark = "unfinished-" + process_mark();
    std::error_code ignored;
    std::vector<fs::path> found;
    for (fs::directory_iterator it(folder, ignored), end; !ignored && it != end;
         it.increment(ignored)) {
        const std::string name = it->path().filename().string();
        if (name.starts_with('.') && name.find(mark) != name.npos) found.push_back(it->path());
    }
    for (const fs::path& path : found) discard(path);
}

void discard_unfinished_outputs() {
    const std::lock_guard lock(outputs_mutex);
    std::error_code ignored;
    for (const Output& output : outputs()) {
        discard_unfinished_in(output.path);
        discard_unfinished_in(output.path.parent_path());
        for (const fs::path& parent : output.missing_parents)
            fs::remove(parent, ignored);  // only if empty
    }
}

void watch() {
    wait_for_signal(-1);
    wait_for_signal(patience_ms);
    end_from_outside(Error(ErrorCode::cancelled, last_words));
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

void catch_interrupts() {
    make_scratch();
    if (pipe(wake_up) != 0) return;  // signals then end the program as the system does
    std::thread(watch).detach();
    catch_one(SIGINT);
    catch_one(SIGTERM);
}

bool is_interrupted() { return num_signals > 0; }

void throw_if_interrupted() {
    if (is_interrupted()) throw Error(ErrorCode::cancelled, last_words);
}

void will_write(const fs::path& path) {
    if (path.empty()) return;
    std::error_code failed;
    Output output{fs::absolute(path, failed).lexically_normal(), {}};
    if (!output.path.has_filename()) output.path = output.path.parent_path();
    for (fs::path parent = output.path.parent_path(); !failed && !fs::exists(parent, failed);
         parent = parent.parent_path())
        output.missing_parents.push_back(parent);
    const std::lock_guard lock(outputs_mutex);
    outputs().push_back(std::move(output));
}

void begin_to_end() {
    if (!is_ending.test_and_set()) return;
    for (;;) pause();
}

void end_from_outside(const Error& reason) {
    begin_to_end();
    discard_unfinished_outputs();
    remove_scratch();
    const std::string sentence = std::string("palpate: ") + reason.what() + "\n";
    const ssize_t ignored = write(STDERR_FILENO, sentence.data(), sentence.size());
    (void)ignored;
    _exit(exit_code_of(reason.code()));
}

ProgressSink interruptible(ProgressSink sink) {
    return [sink = std::move(sink)](const Progress& progress) {
        throw_if_interrupted();
        if (sink && !progress.stage.empty()) sink(progress);
    };
}

}  // namespace palpate
