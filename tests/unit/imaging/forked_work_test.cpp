// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/forked_work.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// The message of the Error that `work` leads to, after checking its code.
std::string failure_of(const std::function<void()>& work, ErrorCode code,
                       const ReadingLimits& limits = {}) {
    try {
        run_in_child(work, limits);
        ADD_FAILURE() << "no error";
        return "";
    } catch (const Error& error) {
        EXPECT_EQ(int(error.code()), int(code));
        return error.what();
    }
}

TEST(ChildProcess, LeavesItsResultInSharedMemory) {
    const SharedMemory memory(3 * sizeof(int));
    int* numbers = reinterpret_cast<int*>(memory.data());

    run_in_child([&] { numbers[2] = 42; });

    EXPECT_EQ(numbers[2], 42);
}

TEST(ChildProcess, HandsOnAnErrorWithItsCode) {
    auto work = [] { throw Error(ErrorCode::input_unusable, "a reason"); };

    EXPECT_EQ(failure_of(work, ErrorCode::input_unusable), "a reason");
}

TEST(ChildProcess, TurnsAForeignExceptionIntoAnUnreadableInput) {
    auto work = [] { throw std::runtime_error("odd"); };

    EXPECT_EQ(failure_of(work, ErrorCode::input_unreadable), "odd");
}

TEST(ChildProcess, SurvivesACrash) {
    auto work = [] { std::raise(SIGSEGV); };

    EXPECT_NE(failure_of(work, ErrorCode::input_unreadable).find("crashed"), std::string::npos);
}

TEST(ChildProcess, SurvivesAnAbort) {
    EXPECT_NE(failure_of([] { std::abort(); }, ErrorCode::input_unreadable).find("crashed"),
              std::string::npos);
}

TEST(ChildProcess, EndsAnEndlessLoop) {
    ReadingLimits limits;
    limits.seconds = 1;
    auto work = [] {
        volatile bool forever = true;
        while (forever) {
        }
    };

    EXPECT_NE(failure_of(work, ErrorCode::input_unreadable, limits).find("too long"),
              std::string::npos);
}

TEST(ChildProcess, LimitsMemory) {
#ifdef PALPATE_ADDRESS_SANITIZER
    GTEST_SKIP() << "address space is not limited under the sanitizer";
#endif
    ReadingLimits limits;
    limits.memory_bytes = std::size_t(64) << 20;
    auto work = [] {
        std::vector<char> large(std::size_t(1) << 30, 'x');
        if (large[12345] != 'x') std::abort();
    };

    EXPECT_NE(failure_of(work, ErrorCode::input_unreadable, limits).find("memory"),
              std::string::npos);
}

TEST(ChildProcess, SaysNothing) {
    ::testing::internal::CaptureStderr();
    run_in_child([] {
        std::fprintf(stderr, "noise");
        std::fflush(stderr);
    });
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace palpate
