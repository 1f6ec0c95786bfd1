// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Calls body(begin, end) on consecutive parts of 0..count, one part per hardware thread, and
/// waits. Parts must write to disjoint memory; then the result does not depend on the number of
/// threads. The first exception that a part throws is thrown again here.
template <typename Body>
void parallel_ranges(Index count, const Body& body) {
    const Index num_threads =
        std::clamp<Index>(static_cast<Index>(std::thread::hardware_concurrency()), 1, 16);
    if (count < 2 * num_threads || num_threads == 1) {
        if (count > 0) body(Index(0), count);
        return;
    }
    std::vector<std::exception_ptr> errors(num_threads);
    std::vector<std::thread> threads;
    for (Index t = 0; t < num_threads; ++t) {
        const Index begin = static_cast<Index>(std::int64_t(count) * t / num_threads);
        const Index end = static_cast<Index>(std::int64_t(count) * (t + 1) / num_threads);
        threads.emplace_back([&body, &errors, t, begin, end] {
            try {
                body(begin, end);
            } catch (...) {
                errors[t] = std::current_exception();
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::exception_ptr& error : errors) {
        if (error) std::rethrow_exception(error);
    }
}

}  // namespace palpate
