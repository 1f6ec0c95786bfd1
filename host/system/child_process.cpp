// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int start_limit_ms = 30000;  // of fork and exec
constexpr int inherited_as = 3;
constexpr int first_own_descriptor = 10;  // so that `inherited_as` is never one of ours

struct PipeEnds {
    int read_end = -1, write_end = -1;
    PipeEnds() {
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0)
            throw Error(ErrorCode::internal, "cannot make a pipe: too many open files?");
        read_end = ends[0];
        write_end = ::fcntl(ends[1], F_DUPFD_CLOEXEC, first_own_descriptor);
        ::close(ends[1]);
        if (write_end >= 0) return;
        close_end(read_end);
        throw Error(ErrorCode::internal, "cannot make a pipe: too many open files?");
    }
    ~PipeEnds() {
        close_end(read_end);
        close_end(write_end);
    }
    PipeEnds(const PipeEnds&) = delete;
    PipeEnds& operator=(const PipeEnds&) = delete;
    static void close_end(int& end) {
        if (end >= 0) ::close(end);
        end = -1;
    }
    /// The end to read from, now the caller's.
    int take_read_end() {
        const int taken = read_end;
        read_end = -1;
        ::fcntl(taken, F_SETFL, O_NONBLOCK);
        return taken;
    }
};

void set_limit(int resource, double value) {
    rlimit limit{};
    limit.rlim_cur = limit.rlim_max = static_cast<rlim_t>(value);
    ::setrlimit(static_cast<__rlimit_resource_t>(resource), &limit);
}

/// Between fork and exec: only calls that are safe in a forked child of a threaded program.
[[noreturn]] void become(char* const* argv, const ChildSetup& setup, pid_t parent, int output,
                         int errors, int report) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(126);
    set_limit(RLIMIT_CORE, 0);
    if (setup.processor_s > 0) set_limit(RLIMIT_CPU, std::ceil(setup.processor_s) + 1);
#ifndef PALPATE_ADDRESS_SANITIZER  // its shadow memory alone is larger than any useful limit
    if (setup.memory_gib > 0) set_limit(RLIMIT_AS, setup.memory_gib * 1024 * 1024 * 1024);
#endif
    sigset_t none;
    ::sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    for (const int caught : {SIGINT, SIGTERM, SIGPIPE}) ::signal(caught, SIG_DFL);
    const int nothing = ::open("/dev/null", O_RDONLY);
    if (nothing < 0 || ::dup2(nothing, 0) < 0 || ::dup2(output, 1) < 0 || ::dup2(errors, 2) < 0)
        ::_exit(126);
    unsigned first_closed = inherited_as;
    if (setup.inherited >= 0) {
        ++first_closed;
        if (setup.inherited == inherited_as)
            ::fcntl(setup.inherited, F_SETFD, 0);
        else if (::dup2(setup.inherited, inherited_as) < 0)
            ::_exit(126);
    }
#ifdef SYS_close_range
    // 4: close on exec, so that `report` can still be used
    ::syscall(SYS_close_range, first_closed, ~0U, 4U);
#endif
    ::execv(argv[0], argv);
    const int why = errno;
    const ssize_t ignored = ::write(report, &why, sizeof why);
    ::_exit(ignored < 0 ? 126 : 127);
}

/// A fork that runs none of the handlers which libraries leave for it: ITK's takes a lock in the
/// child that a thread of the parent may hold at that moment, and waits for ever.
pid_t bare_fork() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 34)
    return ::_Fork();
#else
    return ::fork();
#endif
}

/// Waits until the program runs, which closes `report`, or says why it does not.
void throw_if_not_started(PipeEnds& report, const std::filesystem::path& program) {
    PipeEnds::close_end(report.write_end);
    pollfd end{report.read_end, POLLIN, 0};
    int ready = 0;
    while ((ready = ::poll(&end, 1, start_limit_ms)) < 0 && errno == EINTR) {
    }
    if (ready == 0)
        throw Error(ErrorCode::internal, "'" + program.string() + "' did not start within " +
                                             std::to_string(start_limit_ms / 1000) + " s");
    int why = 0;
    ssize_t got = 0;
    while ((got = ::read(report.read_end, &why, sizeof why)) < 0 && errno == EINTR) {
    }
    if (got == sizeof why)
        throw Error(ErrorCode::unsupported,
                    "cannot start '" + program.string() + "': " + std::strerror(why));
}

void end_group(pid_t id) {
    ::kill(-id, SIGKILL);
    ::kill(id, SIGKILL);
    int status = 0;
    while (::waitpid(id, &status, 0) < 0 && errno == EINTR) {
    }
}

}  // namespace

void TextPipe::close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
}

void TextPipe::drain(std::string& text) {
    std::array<char, 65536> buffer;
    while (descriptor_ >= 0) {
        const ssize_t got = ::read(descriptor_, buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 && errno == EAGAIN) return;
        if (got <= 0) return close();
        text.append(buffer.data(), static_cast<std::size_t>(got));
        if (text.size() >= buffer.size() || static_cast<std::size_t>(got) < buffer.size())
            return;  // the others' turn
    }
}

ChildProcess::ChildProcess(const std::filesystem::path& program,
                           const std::vector<std::string>& arguments, const ChildSetup& setup) {
    std::string name = program.string();
    std::vector<std::string> words = arguments;
    std::vector<char*> argv{name.data()};
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    PipeEnds output, errors, report;
    const pid_t parent = ::getpid();
    id_ = bare_fork();
    if (id_ < 0) throw Error(ErrorCode::out_of_memory, "cannot start a process for '" + name + "'");
    if (id_ == 0)
        become(argv.data(), setup, parent, output.write_end, errors.write_end, report.write_end);
    try {
        throw_if_not_started(report, program);
    } catch (...) {
        end_group(id_);
        throw;
    }
    output_.emplace(output.take_read_end());
    errors_.emplace(errors.take_read_end());
}

ChildProcess::~ChildProcess() {
    if (id_ > 0) end_group(id_);
}

std::optional<ChildEnd> ChildProcess::ended() {
    int status = 0;
    if (id_ <= 0 || ::waitpid(id_, &status, WNOHANG) != id_) return std::nullopt;
    ::kill(-id_, SIGKILL);  // what it has left behind
    id_ = -1;
    if (WIFEXITED(status)) return ChildEnd{WEXITSTATUS(status), 0};
    return ChildEnd{-1, WTERMSIG(status)};
}

void ChildProcess::signal_group(int signal) const {
    if (id_ <= 0) return;
    ::kill(-id_, signal);
    ::kill(id_, signal);
}

}  // namespace palpate
