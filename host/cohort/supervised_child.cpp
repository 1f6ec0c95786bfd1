// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/supervised_child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t longest_log = 16 * 1024;
constexpr std::size_t longest_line = 4 << 20;
constexpr int inherited_as = 3;

struct PipeEnds {
    int read = -1, write = -1;
};

PipeEnds make_pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0)
        throw Error(ErrorCode::internal, "cannot make a pipe: too many open files?");
    ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
    return {ends[0], ends[1]};
}

/// Between fork and exec: only calls that are safe in a forked child of a threaded program.
[[noreturn]] void become_patient(char* const* argv, pid_t parent, int output, int errors,
                                 int inherited) {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(126);
    rlimit none{};
    ::setrlimit(RLIMIT_CORE, &none);
    sigset_t empty;
    ::sigemptyset(&empty);
    ::sigprocmask(SIG_SETMASK, &empty, nullptr);
    for (const int caught : {SIGINT, SIGTERM, SIGPIPE}) ::signal(caught, SIG_DFL);
    const int nothing = ::open("/dev/null", O_RDONLY);
    if (nothing < 0 || ::dup2(nothing, 0) < 0 || ::dup2(output, 1) < 0 || ::dup2(errors, 2) < 0)
        ::_exit(126);
    if (inherited == inherited_as) {
        ::fcntl(inherited, F_SETFD, 0);
    } else if (::dup2(inherited, inherited_as) < 0) {
        ::_exit(126);
    }
#ifdef SYS_close_range
    ::syscall(SYS_close_range, unsigned(inherited_as + 1), ~0U, 0U);
#endif
    ::execv(argv[0], argv);
    ::_exit(127);
}

/// Without the handlers that libraries leave for a fork.
pid_t fork_barely() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 34)
    return ::_Fork();
#else
    return ::fork();
#endif
}

}  // namespace

SupervisedChild::SupervisedChild(const std::filesystem::path& program,
                                 const std::vector<std::string>& arguments, int inherited) {
    std::string name = program.string();
    std::vector<std::string> words = arguments;
    std::vector<char*> argv{name.data()};
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const PipeEnds output = make_pipe(), errors = make_pipe();
    const pid_t parent = ::getpid();
    id_ = fork_barely();
    if (id_ == 0) become_patient(argv.data(), parent, output.write, errors.write, inherited);
    ::close(output.write);
    ::close(errors.write);
    output_ = output.read;
    errors_ = errors.read;
    if (id_ > 0) return;
    ::close(output_);
    ::close(errors_);
    throw Error(ErrorCode::internal, "cannot start a process for a patient");
}

SupervisedChild::~SupervisedChild() {
    if (id_ > 0) {
        signal_group(SIGKILL);
        int status = 0;
        while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
        }
    }
    for (const int end : {output_, errors_})
        if (end >= 0) ::close(end);
}

void SupervisedChild::drain(int& end, std::string& text) {
    std::array<char, 65536> buffer;
    while (end >= 0) {
        const ssize_t got = ::read(end, buffer.data(), buffer.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 && errno == EAGAIN) return;
        if (got <= 0) {
            ::close(end);
            end = -1;
            return;
        }
        text.append(buffer.data(), static_cast<std::size_t>(got));
        if (static_cast<std::size_t>(got) < buffer.size()) return;  // the others' turn
    }
}

void SupervisedChild::read(const std::function<void(const std::string&)>& line) {
    drain(errors_, log_);
    if (log_.size() > longest_log) log_.erase(0, log_.size() - longest_log);
    drain(output_, lines_);
    std::size_t begin = 0;
    for (std::size_t end; (end = lines_.find('\n', begin)) != std::string::npos; begin = end + 1)
        line(lines_.substr(begin, end - begin));
    lines_.erase(0, begin);
    if (lines_.size() > longest_line) lines_.clear();
}

std::optional<ChildEnd> SupervisedChild::ended() {
    if (id_ <= 0) return std::nullopt;
    int status = 0;
    if (::waitpid(id_, &status, WNOHANG) != id_) return std::nullopt;
    signal_group(SIGKILL);  // what it has left behind
    id_ = -1;
    if (WIFEXITED(status)) return ChildEnd{WEXITSTATUS(status), 0};
    return ChildEnd{-1, WTERMSIG(status)};
}

void SupervisedChild::signal_group(int signal) const {
    if (id_ <= 0) return;
    ::kill(-id_, signal);
    ::kill(id_, signal);
}

}  // namespace palpate
