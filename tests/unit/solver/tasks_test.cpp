// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/base/tasks.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace palpate {
namespace {

using namespace std::chrono_literals;

TEST(Tasks, AreEachDoneOnceByAnyNumberOfThreads) {
    for (const int jobs : {1, 2, 8})
        for (const std::size_t count : {0u, 1u, 5u}) {
            SharedProgress progress({});
            std::vector<std::atomic<int>> done(count);
            run_tasks(count, jobs, progress, [&](std::size_t k) { ++done[k]; });
            for (const auto& times : done) EXPECT_EQ(times, 1);
        }
}

TEST(Tasks, WithinATaskRunOneAfterTheOther) {
    SharedProgress outer({});
    std::atomic<int> running = 0, most = 0;
    run_tasks(2, 2, outer, [&](std::size_t) {
        EXPECT_EQ(jobs_here(4), 1);
        SharedProgress inner({});
        run_tasks(4, 4, inner, [&](std::size_t) {
            const int now = ++running;
            for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) continue;
            std::this_thread::sleep_for(5ms);
            --running;
        });
    });
    EXPECT_LE(most, 2);
    EXPECT_EQ(jobs_here(4), 4);
}

/// Counts who is between `enter` and `leave`.
class Meeting {
public:
    void enter() {
        const int now = ++inside_;
        for (int seen = most_; now > seen && !most_.compare_exchange_weak(seen, now);) continue;
    }
    void leave() { --inside_; }
    int most() const { return most_; }

private:
    std::atomic<int> inside_ = 0, most_ = 0;
};

TEST(Tasks, ShareTheThreadsThatNoTaskHas) {
    SharedProgress outer({});
    Meeting meeting;
    run_tasks(2, 5, outer, [&](std::size_t) {
        EXPECT_EQ(jobs_here(8), 2);  // two of five each
        EXPECT_EQ(jobs_here(1), 1);
        SharedProgress inner({});
        std::atomic<int> met = 0;
        run_tasks(2, 8, inner, [&](std::size_t) {
            EXPECT_EQ(jobs_here(8), 1);
            meeting.enter();
            ++met;
            for (int wait = 0; met < 2 && wait < 2000; ++wait) std::this_thread::sleep_for(1ms);
            meeting.leave();
        });
        EXPECT_EQ(met, 2);
        EXPECT_EQ(jobs_here(8), 2);
    });
    EXPECT_GE(meeting.most(), 2);
    EXPECT_LE(meeting.most(), 4);
    EXPECT_EQ(jobs_here(8), 8);
}

TEST(Tasks, OfOneThreadHaveThatOneAndASingleTaskHasAll) {
    SharedProgress outer({});
    Meeting meeting;
    run_tasks(3, 1, outer, [&](std::size_t) {
        EXPECT_EQ(jobs_here(8), 1);
        SharedProgress inner({});
        run_tasks(3, 8, inner, [&](std::size_t) {
            meeting.enter();
            std::this_thread::sleep_for(1ms);
            meeting.leave();
        });
    });
    EXPECT_EQ(meeting.most(), 1);
    run_tasks(1, 4, outer, [](std::size_t) { EXPECT_EQ(jobs_here(8), 4); });
}

TEST(Tasks, RunSideBySideAgainAfterNestedOnes) {
    SharedProgress outer({});
    run_tasks(2, 2, outer, [](std::size_t) {});
    EXPECT_EQ(jobs_here(4), 4);
    std::atomic<int> met = 0;
    run_tasks(2, 2, outer, [&](std::size_t) {
        ++met;
        for (int wait = 0; met < 2 && wait < 2000; ++wait) std::this_thread::sleep_for(1ms);
    });
    EXPECT_EQ(met, 2);
}

TEST(Tasks, StopTheOthersWhenOneFails) {
    SharedProgress progress({});
    std::atomic<int> begun = 0;
    std::atomic<bool> is_stopped = false;
    try {
        run_tasks(20, 2, progress, [&](std::size_t k) {
            ++begun;
            if (k == 0) throw Error(ErrorCode::solve_failed, "the first");
            try {
                for (int wait = 0; wait < 2000; ++wait) {
                    check_cancelled(progress.sink());
                    std::this_thread::sleep_for(1ms);
                }
            } catch (const Error&) {
                is_stopped = true;
                throw;
            }
        });
        FAIL() << "no failure came out";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::solve_failed);
    }
    EXPECT_LE(begun, 2);
    EXPECT_TRUE(begun < 2 || is_stopped);
    EXPECT_THROW(run_tasks(1, 1, progress, [](std::size_t) {}), Error);
}

TEST(Tasks, AskTheCallersThreadWhileItWaits) {
    const auto caller = std::this_thread::get_id();
    std::atomic<bool> asks = false;
    SharedProgress progress([&](const Progress&) {
        if (asks && std::this_thread::get_id() == caller)
            throw Error(ErrorCode::cancelled, "the user asked for it");
    });
    try {
        run_tasks(2, 2, progress, [&](std::size_t) {
            if (std::this_thread::get_id() == caller) return;
            asks = true;
            for (int wait = 0; wait < 5000; ++wait) {
                check_cancelled(progress.sink());
                std::this_thread::sleep_for(1ms);
            }
        });
        // the caller may have done both
        EXPECT_FALSE(asks);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
        EXPECT_EQ(std::string(error.what()), "the user asked for it");
    }
}

}  // namespace
}  // namespace palpate
