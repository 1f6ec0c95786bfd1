// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/forked_work.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>
#include <thread>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// What the child says at its end, in shared memory.
struct Report {
    enum class State : int { silent, done, error, failed } state;
    ErrorCode code;
    char message[1000];

    void set(State new_state, const char* text) {
        std::snprintf(message, sizeof message, "%s", text);
        state = new_state;
    }
};

#ifndef PALPATE_ADDRESS_SANITIZER
std::size_t mapped_bytes() {
    unsigned long pages = 0;
    if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
        if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
        std::fclose(file);
    }
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}
#endif

void lower_limit(int resource, rlim_t value) {
    rlimit limit{};
    getrlimit(resource, &limit);
    limit.rlim_cur = std::min(value, limit.rlim_max);
    setrlimit(resource, &limit);
}

void apply(const ReadingLimits& limits) {
#ifndef PALPATE_ADDRESS_SANITIZER  // its shadow memory counts as mapped
    lower_limit(RLIMIT_AS, mapped_bytes() + limits.memory_bytes);
#endif
    lower_limit(RLIMIT_CPU, static_cast<rlim_t>(limits.seconds));
    lower_limit(RLIMIT_CORE, 0);
}

void silence() {
    const int null = open("/dev/null", O_RDWR);
    if (null < 0) return;
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
}

[[noreturn]] void be_child(const std::function<void()>& work, const ReadingLimits& limits,
                           Report& report, [[maybe_unused]] pid_t parent) {
    for (int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU}) {
        std::signal(signal, SIG_DFL);
    }
    for (int signal : {SIGTERM, SIGINT}) std::signal(signal, SIG_IGN);  // the parent decides
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
#endif
    silence();
    apply(limits);
    try {
        work();
        report.set(Report::State::done, "");
    } catch (const Error& error) {
        report.code = error.code();
        report.set(Report::State::error, error.what());
    } catch (const std::bad_alloc&) {
        report.set(Report::State::failed, "it needs more memory than the limit for reading");
    } catch (const std::exception& error) {
        report.set(Report::State::failed, error.what());
    } catch (...) {
        report.set(Report::State::failed, "an unknown exception");
    }
    _exit(0);  // no destructors, no buffers of the parent
}

void kill_and_reap(pid_t child) {
    kill(child, SIGKILL);
    while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
}

/// Status of the child as waitpid gives it; kills it when its time is over or `tick` throws.
int wait_for(pid_t child, int seconds, const std::function<void()>& tick) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
    int status = 0;
    for (auto pause = std::chrono::microseconds(200);;
         pause = std::min(pause * 2, std::chrono::microseconds(10000))) {
        const pid_t ended = waitpid(child, &status, WNOHANG);
        if (ended == child) return status;
        if (ended < 0 && errno != EINTR) return -1;
        if (std::chrono::steady_clock::now() > end) kill(child, SIGKILL);
        try {
            if (tick) tick();
        } catch (...) {
            kill_and_reap(child);
            throw;
        }
        std::this_thread::sleep_for(pause);
    }
}

/// Runs in the child. A reader that complains to stderr and goes on has made something up.
void read_without_complaints(const std::function<void()>& read) {
    int ends[2];  // what does not fit is lost, not waited for
    const bool listens = pipe2(ends, O_NONBLOCK | O_CLOEXEC) == 0;
    if (listens) dup2(ends[1], STDERR_FILENO);
    read();
    char said[300];
    const ssize_t length = listens ? ::read(ends[0], said, sizeof said) : 0;
    if (length <= 0) return;
    throw Error(ErrorCode::input_unreadable,
                "it is damaged: " + std::string(said, std::find(said, said + length, '\n')));
}

std::string cause_of(int status) {
    if (status < 0 || !WIFSIGNALED(status)) return "the reading process ended without a result";
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU || signal == SIGKILL) return "reading it took too long";
    return "reading it crashed (signal " + std::to_string(signal) + ")";
}

}  // namespace

SharedMemory::SharedMemory(std::size_t num_bytes)
    : num_bytes_(std::max<std::size_t>(num_bytes, 1)) {
    void* memory =
        mmap(nullptr, num_bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        throw Error(ErrorCode::out_of_memory,
                    "no memory for " + std::to_string(num_bytes_) + " bytes of image");
    }
    data_ = static_cast<std::byte*>(memory);
}

SharedMemory::~SharedMemory() { munmap(data_, num_bytes_); }

void run_in_child(const std::function<void()>& work, const ReadingLimits& limits,
                  const std::function<void()>& tick) {
    const SharedMemory memory(sizeof(Report));
    Report& report = *new (memory.data()) Report{};
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child < 0) throw Error(ErrorCode::out_of_memory, "no process could be started");
    if (child == 0) be_child(work, limits, report, parent);
    const int status = wait_for(child, 2 * limits.seconds, tick);
    switch (report.state) {
        case Report::State::done:
            return;
        case Report::State::error:
            throw Error(report.code, report.message);
        case Report::State::failed:
            throw Error(ErrorCode::input_unreadable, report.message);
        case Report::State::silent:
            break;
    }
    throw Error(ErrorCode::input_unreadable, cause_of(status));
}

void write_in_child(const std::function<void()>& write, std::size_t num_bytes) {
    ReadingLimits limits;  // writers hold several copies, and may compress for long
    limits.memory_bytes += 8 * num_bytes;
    limits.seconds = 60 + static_cast<int>(num_bytes >> 22);
    try {
        run_in_child(write, limits);
    } catch (const Error&) {
        throw Error(ErrorCode::output_failed, "it could not be written whole");
    }
}

void read_in_child(const std::filesystem::path& path, const std::function<void()>& read) {
    std::error_code failed;
    const std::uintmax_t size = std::filesystem::file_size(path, failed);
    const std::uintmax_t bytes = failed ? 0 : std::min<std::uintmax_t>(size, 8ull << 30);
    ReadingLimits limits;
    limits.memory_bytes += 64 * bytes;  // compressed files grow, and readers hold several copies
    limits.seconds = 8 + static_cast<int>(bytes >> 20);
    try {
        run_in_child([&] { read_without_complaints(read); }, limits);
    } catch (const Error& error) {
        const std::string what = error.what(), name = path.string();
        if (error.code() != ErrorCode::input_unreadable || what.find(name) != std::string::npos)
            throw;
        throw Error(ErrorCode::input_unreadable, "cannot read '" + name + "': " + what);
    }
}

}  // namespace palpate
