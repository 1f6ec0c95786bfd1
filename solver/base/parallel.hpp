// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <exception>
#include <thread>
#include <type_traits>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

inline Index num_host_threads() {
    static const auto found =
        static_cast<Index>(std::clamp(std::thread::hardware_concurrency(), 1u, 64u));
    return found;  // asking the system each time costs more than some loops
}

/// Calls `work(begin, end)` on consecutive parts of [0, count), one part per host thread. Parts
/// write to disjoint places, so the result does not depend on the number of threads. With fewer
/// than `smallest_part` items per thread fewer threads are used. The first exception is rethrown.
template <typename Count, typename Work>
void parallel_ranges(Count count, std::type_identity_t<Count> smallest_part, Work&& work) {
    if (!(count > 0)) return;
    const Count wanted = count / std::max<Count>(smallest_part, 1);
    const Index parts =
        static_cast<Index>(std::clamp<Count>(wanted, 1, static_cast<Count>(num_host_threads())));
    std::vector<std::exception_ptr> failures(parts);
    auto run = [&](Index part) {
        const auto edge = [&](Index p) {
            return static_cast<Count>(static_cast<std::int64_t>(count) * p / parts);
        };
        try {
            work(edge(part), edge(part + 1));
        } catch (...) {
            failures[part] = std::current_exception();
        }
    };
    std::vector<std::jthread> threads;  // joined, too, when one cannot be started
    for (Index part = 1; part < parts; ++part) threads.emplace_back(run, part);
    run(0);
    for (std::jthread& thread : threads) thread.join();
    for (const std::exception_ptr& failure : failures)
        if (failure) std::rethrow_exception(failure);
}

}  // namespace palpate
