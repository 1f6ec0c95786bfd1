// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/child_program.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>

#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

const std::filesystem::path shell = "/bin/sh";  // a program at hand; run_child itself uses none

TEST(ChildProcess, returns_both_texts_and_the_exit_code) {
    const ChildResult result = run_child(shell, {"-c", "echo out; echo err >&2; exit 5"}, {});
    EXPECT_EQ(result.output, "out\n");
    EXPECT_EQ(result.errors, "err\n");
    EXPECT_EQ(result.exit_code, 5);
    EXPECT_FALSE(result.ok());
}

TEST(ChildProcess, reports_the_signal_that_ended_it) {
    const ChildResult result = run_child(shell, {"-c", "kill -SEGV $$"}, {});
    EXPECT_EQ(result.signal, SIGSEGV);
    EXPECT_EQ(result.exit_code, -1);
    EXPECT_FALSE(result.timed_out);
}

TEST(ChildProcess, kills_a_sleeper_and_its_children_at_the_time_limit) {
    const ChildResult result = run_child(shell, {"-c", "sleep 30 & sleep 30"}, {0.3, 1});
    EXPECT_TRUE(result.timed_out);
    EXPECT_LT(result.seconds, 2.5);
}

TEST(ChildProcess, kills_a_busy_loop_that_closed_its_outputs) {
    const ChildResult result =
        run_child(shell, {"-c", "exec >&- 2>&-; while :; do :; done"}, {0.3, 1});
    EXPECT_TRUE(result.timed_out);
    EXPECT_LT(result.seconds, 2.5);
}

TEST(ChildProcess, limits_the_text_it_keeps) {
    const ChildResult result =
        run_child(shell, {"-c", "head -c 1000000 /dev/zero; exit 3"}, {10, 1});
    EXPECT_EQ(result.output.size(), 65536u);
    EXPECT_EQ(result.exit_code, 3);
}

TEST(ChildProcess, kills_the_child_when_the_caller_cancels) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_THROW(run_child(shell, {"-c", "sleep 30"}, {60, 1},
                           [](double seconds) {
                               if (seconds > 0.2) throw Error(ErrorCode::time_limit, "cancelled");
                           }),
                 Error);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    EXPECT_LT(taken.count(), 2.5);
}

TEST(ChildProcess, gives_the_child_no_input_and_no_open_file) {
    std::ifstream open_file("/dev/null");
    const ChildResult result = run_child(shell, {"-c", "cat; ls /proc/self/fd | wc -l"}, {});
    EXPECT_EQ(result.output, "4\n");  // 0, 1, 2 and the one that ls opens on the folder
}

bool handlers_hang = false;

void hang_in_the_child() {
    while (handlers_hang) pause();
}

// As a library's handler does that takes a lock in the child which nobody there will ever release.
TEST(ChildProcess, starts_whatever_libraries_do_when_the_process_forks) {
    ASSERT_EQ(pthread_atfork(nullptr, nullptr, hang_in_the_child), 0);
    handlers_hang = true;
    const ChildResult result = run_child(shell, {"-c", "echo here"}, {10, 1});
    handlers_hang = false;
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.output, "here\n");
}

TEST(ChildProcess, says_that_a_program_does_not_exist) {
    try {
        run_child("/nowhere/palpate-mesh", {}, {});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
    }
}

TEST(PrivateFolder, is_private_and_removed_with_its_files) {
    std::filesystem::path path;
    {
        const PrivateFolder folder;
        path = folder.path();
        std::ofstream(path / "file") << "x";
        EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms::owner_all);
    }
    EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace palpate
