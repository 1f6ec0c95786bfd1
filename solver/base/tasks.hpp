// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace palpate {

/// Calls `work(k)` once for each k in [0, count), on at most `jobs` threads, that of the caller
/// among them: for few tasks that each take long. All are done; then the first exception, by k, is
/// rethrown.
template <typename Work>
void run_tasks(std::size_t count, int jobs, Work&& work) {
    std::atomic<std::size_t> next = 0;
    std::vector<std::exception_ptr> failures(count);
    const auto run = [&] {
        for (std::size_t k = next++; k < count; k = next++) {
            try {
                work(k);
            } catch (...) {
                failures[k] = std::current_exception();
            }
        }
    };
    {
        std::vector<std::jthread> threads;
        for (int t = 1; t < std::min(jobs, static_cast<int>(count)); ++t) threads.emplace_back(run);
        run();
    }
    for (const std::exception_ptr& failure : failures)
        if (failure) std::rethrow_exception(failure);
}

}  // namespace palpate
