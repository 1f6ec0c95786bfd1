// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/child_program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "solver/base/error.hpp"

namespace palpate {

namespace {

constexpr std::size_t max_text = 64 * 1024;
constexpr int tick_ms = 100;
constexpr int start_limit_ms = 30000;  // of fork and exec
constexpr double seconds_after_kill = 2;

struct Pipe {
    int read_end = -1, write_end = -1;
    Pipe() {
        int ends[2];
        if (pipe2(ends, O_CLOEXEC) != 0)
            throw Error(ErrorCode::internal, "cannot make a pipe: too many open files?");
        read_end = ends[0];
        write_end = ends[1];
    }
    ~Pipe() {
        close_end(read_end);
        close_end(write_end);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
    static void close_end(int& end) {
        if (end >= 0) ::close(end);
        end = -1;
    }
};

void set_limit(int resource, double value) {
    rlimit limit{};
    limit.rlim_cur = limit.rlim_max = static_cast<rlim_t>(value);
    setrlimit(static_cast<__rlimit_resource_t>(resource), &limit);
}

/// Between fork and exec: only calls that are safe in a forked child of a threaded program.
[[noreturn]] void become(char* const* argv, const ChildLimits& limits, pid_t parent, int output,
                         int errors, int report) {
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(126);
    set_limit(RLIMIT_CORE, 0);
    set_limit(RLIMIT_CPU, std::ceil(limits.seconds) + 1);
#ifndef PALPATE_ADDRESS_SANITIZER  // its shadow memory alone is larger than any useful limit
    set_limit(RLIMIT_AS, limits.memory_gib * 1024 * 1024 * 1024);
#endif
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    signal(SIGPIPE, SIG_DFL);
    const int nothing = open("/dev/null", O_RDONLY);
    if (nothing < 0 || dup2(nothing, 0) < 0 || dup2(output, 1) < 0 || dup2(errors, 2) < 0)
        _exit(126);
#ifdef SYS_close_range
    syscall(SYS_close_range, 3U, ~0U, 4U);  // 4: close on exec, so that `report` can still be used
#endif
    execv(argv[0], argv);
    const int why = errno;
    const ssize_t ignored = write(report, &why, sizeof why);
    _exit(ignored < 0 ? 126 : 127);
}

/// A fork that runs none of the handlers which libraries leave for it: ITK's takes a lock in the
/// child that a thread of the parent may hold at that moment, and waits for ever.
pid_t bare_fork() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 34)
    return _Fork();
#else
    return fork();
#endif
}

/// Kills and reaps the child if it is still there when an exception passes.
class Child {
public:
    explicit Child(pid_t id) : id_(id) {}
    ~Child() {
        if (id_ <= 0) return;
        kill();
        int status = 0;
        while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
        }
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    void kill() const {
        ::kill(-id_, SIGKILL);
        ::kill(id_, SIGKILL);
    }
    bool ended(int& status) {
        if (waitpid(id_, &status, WNOHANG) != id_) return false;
        id_ = -1;
        return true;
    }

private:
    pid_t id_;
};

/// Appends what can be read; closes the end at its end. Text beyond the limit is thrown away.
void drain(int& end, std::string& text) {
    std::array<char, 4096> buffer;
    const ssize_t got = read(end, buffer.data(), buffer.size());
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) return;
    if (got <= 0) return Pipe::close_end(end);
    const std::size_t room = max_text - std::min(max_text, text.size());
    text.append(buffer.data(), std::min(room, static_cast<std::size_t>(got)));
}

void wait_for_text(Pipe& output, Pipe& errors, ChildResult& result) {
    std::array<pollfd, 2> ends{pollfd{output.read_end, POLLIN, 0},
                               pollfd{errors.read_end, POLLIN, 0}};
    if (poll(ends.data(), ends.size(), tick_ms) <= 0) return;
    if (ends[0].revents) drain(output.read_end, result.output);
    if (ends[1].revents) drain(errors.read_end, result.errors);
}

void throw_if_not_started(Pipe& report, const std::filesystem::path& program) {
    Pipe::close_end(report.write_end);
    pollfd end{report.read_end, POLLIN, 0};
    int ready = 0;
    while ((ready = poll(&end, 1, start_limit_ms)) < 0 && errno == EINTR) {
    }
    if (ready == 0)
        throw Error(ErrorCode::internal, "'" + program.string() + "' did not start within " +
                                             std::to_string(start_limit_ms / 1000) + " s");
    int why = 0;
    ssize_t got = 0;
    while ((got = read(report.read_end, &why, sizeof why)) < 0 && errno == EINTR) {
    }
    if (got == sizeof why)
        throw Error(ErrorCode::unsupported,
                    "cannot start '" + program.string() + "': " + std::strerror(why));
}

}  // namespace

ChildResult run_child(const std::filesystem::path& program,
                      const std::vector<std::string>& arguments, const ChildLimits& limits,
                      const std::function<void(double)>& tick) {
    std::string name = program.string();
    std::vector<std::string> words = arguments;
    std::vector<char*> argv{name.data()};
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    Pipe output, errors, report;
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const pid_t parent = getpid();
    const pid_t id = bare_fork();
    if (id < 0) throw Error(ErrorCode::out_of_memory, "cannot start a process for '" + name + "'");
    if (id == 0)
        become(argv.data(), limits, parent, output.write_end, errors.write_end, report.write_end);
    Child child(id);
    Pipe::close_end(output.write_end);
    Pipe::close_end(errors.write_end);
    throw_if_not_started(report, program);

    ChildResult result;
    int status = 0;
    while (output.read_end >= 0 || errors.read_end >= 0) {
        wait_for_text(output, errors, result);
        const double now = elapsed();
        if (!result.timed_out && now > limits.seconds) {
            result.timed_out = true;
            child.kill();
        }
        if (now > limits.seconds + seconds_after_kill) break;  // a grandchild holds the pipe
        if (tick && !result.timed_out) tick(now);
    }
    while (!child.ended(status)) {
        if (elapsed() > limits.seconds) {
            result.timed_out = true;
            child.kill();
        }
        usleep(1000);
    }
    result.seconds = elapsed();
    if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    if (result.signal == SIGXCPU) result.timed_out = true;
    return result;
}

}  // namespace palpate
