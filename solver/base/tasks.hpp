// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "solver/base/error.hpp"
#include "solver/base/log.hpp"
#include "solver/base/serial_blas.hpp"

namespace palpate {

/// A sink that tasks side by side share. It passes one report on at a time; once it is told to
/// stop, it throws Error(cancelled) to whoever reports or asks.
class SharedProgress {
public:
    explicit SharedProgress(ProgressSink outer) : outer_(std::move(outer)) {}

    void operator()(const Progress& news) {
        if (is_stopped_) throw Error(ErrorCode::cancelled, "another task has stopped this one");
        const std::lock_guard lock(mutex_);
        if (outer_) outer_(news);
    }
    /// For what takes a `ProgressSink`; this object must outlive it.
    ProgressSink sink() {
        return [this](const Progress& news) { (*this)(news); };
    }
    void stop() { is_stopped_ = true; }
    bool is_stopped() const { return is_stopped_; }

private:
    ProgressSink outer_;
    std::mutex mutex_;
    std::atomic<bool> is_stopped_ = false;
};

namespace detail {
inline thread_local bool is_within_task = false;
}

/// Of `jobs` threads those that the caller may use: one within a task.
inline int jobs_here(int jobs) { return detail::is_within_task ? 1 : jobs; }

/// Calls `work(k)` once for each k in [0, count), on at most `jobs` threads, that of the caller
/// among them: for few tasks that each take long. Within a task of another call they run one after
/// the other, so that no more than `jobs` ever run. After a failure no further task begins and
/// `progress` stops the others; then the failure is rethrown. The caller's thread goes on asking
/// `progress` while it waits: a sink may hear of a wish to stop there alone (Python's signals).
template <typename Work>
void run_tasks(std::size_t count, int jobs, SharedProgress& progress, Work&& work) {
    using namespace std::chrono_literals;
    const bool was_within_task = detail::is_within_task;
    const int num_threads = std::min(jobs_here(jobs), static_cast<int>(count));
    std::optional<SerialBlas> serial;
    if (num_threads > 1) serial.emplace();

    std::mutex mutex;
    std::condition_variable one_is_done;
    std::exception_ptr failure;
    std::atomic<std::size_t> next = 0;
    const auto fail = [&] {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        progress.stop();
    };
    const auto run = [&] {
        for (std::size_t k = next++; k < count && !progress.is_stopped(); k = next++) {
            try {
                work(k);
            } catch (...) {
                fail();
            }
        }
    };
    int num_others = std::max(0, num_threads - 1);
    std::vector<std::jthread> threads;
    for (int t = num_others; t > 0; --t)
        threads.emplace_back([&] {
            detail::is_within_task = true;
            run();
            const std::lock_guard lock(mutex);
            --num_others;
            one_is_done.notify_one();
        });
    detail::is_within_task = num_threads > 1 || was_within_task;
    run();
    detail::is_within_task = was_within_task;
    for (std::unique_lock lock(mutex);
         !one_is_done.wait_for(lock, 200ms, [&] { return num_others == 0; });) {
        if (progress.is_stopped()) continue;
        lock.unlock();
        try {
            progress({});
        } catch (...) {
            fail();
        }
        lock.lock();
    }
    threads.clear();
    if (failure) std::rethrow_exception(failure);
    if (progress.is_stopped()) throw Error(ErrorCode::cancelled, "the tasks were stopped before");
}

}  // namespace palpate
