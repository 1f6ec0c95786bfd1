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
/// Threads that a task may use, itself one of them; 0: this is within none.
inline thread_local int num_threads_of_task = 0;
}  // namespace detail

/// Of `jobs` threads those that the caller may use: within a task its share of them.
inline int jobs_here(int jobs) {
    const int share = detail::num_threads_of_task;
    return share > 0 ? std::min(jobs, share) : jobs;
}

/// Calls `work(k)` once for each k in [0, count), on at most `jobs` threads, that of the caller
/// among them: for few tasks that each take long. Each may use as many threads as all leave to it
/// (`jobs_here`), so that no more than `jobs` ever run, whatever calls are nested. After a failure
/// no further task begins and `progress` stops the others; then the failure is rethrown. The
/// caller's thread goes on asking `progress` while it waits: a sink may hear of a wish to stop
/// there alone (Python's signals).
template <typename Work>
void run_tasks(std::size_t count, int jobs, SharedProgress& progress, Work&& work) {
    using namespace std::chrono_literals;
    const int outer_share = detail::num_threads_of_task;
    const int num_threads = std::min(jobs_here(jobs), static_cast<int>(count));
    const int share = std::max(1, jobs_here(jobs) / std::max(1, num_threads));
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
            detail::num_threads_of_task = share;
            run();
            const std::lock_guard lock(mutex);
            --num_others;
            one_is_done.notify_one();
        });
    detail::num_threads_of_task = share;
    run();
    detail::num_threads_of_task = outer_share;
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
