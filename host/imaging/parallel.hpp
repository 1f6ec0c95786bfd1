// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace palpate {

/// Calls body(begin, end) for consecutive pieces that cover 0..count, one piece per core. Pieces
/// may run at the same time; the result must not depend on where they are cut. Rethrows the first
/// exception.
template <typename Body>
void parallel_for(std::size_t count, const Body& body) {
    const std::size_t num_threads =
        std::min<std::size_t>(std::max(1u, std::thread::hardware_concurrency()), count);
    if (num_threads <= 1) {
        if (count > 0) body(std::size_t(0), count);
        return;
    }
    std::vector<std::exception_ptr> errors(num_threads);
    std::vector<std::jthread> threads;  // joined, too, when one cannot be started
    for (std::size_t t = 0; t < num_threads; ++t) {
        threads.emplace_back([&, t] {
            try {
                body(count * t / num_threads, count * (t + 1) / num_threads);
            } catch (...) {
                errors[t] = std::current_exception();
            }
        });
    }
    for (std::jthread& thread : threads) thread.join();
    for (const std::exception_ptr& error : errors) {
        if (error) std::rethrow_exception(error);
    }
}

}  // namespace palpate
