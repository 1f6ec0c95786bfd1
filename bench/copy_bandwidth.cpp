// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/copy_bandwidth.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include "solver/base/parallel.hpp"

namespace palpate::bench {
namespace {

constexpr int num_tries = 5;
constexpr double try_bytes = 2e8;  ///< moved per try: long against starting a thread or a kernel

template <typename Copy>
double best_bandwidth(double bytes_per_copy, Copy&& copy) {
    const int repeats = static_cast<int>(std::ceil(try_bytes / bytes_per_copy));
    double best = 0;
    for (int i = 0; i < num_tries; ++i) {
        const auto start = std::chrono::steady_clock::now();
        copy(repeats);
        const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
        best = std::max(best, repeats * bytes_per_copy / time.count());
    }
    return best;
}

/// One copy of a thread's part; not inlined, so that no repetition is left out.
[[gnu::noinline]] void copy_part(const float* from, float* to, Index count) {
    std::copy(from, from + count, to);
}

}  // namespace

double host_copy_bandwidth(double working_set_bytes) {
    const Index count = static_cast<Index>(std::max(4096.0, working_set_bytes / 8));
    std::vector<float> from(count, 1.0f), to(count, 0.0f);
    return best_bandwidth(8.0 * count, [&](int repeats) {
        parallel_ranges(count, 1, [&](Index begin, Index end) {
            for (int i = 0; i < repeats; ++i)
                copy_part(from.data() + begin, to.data() + begin, end - begin);
        });
    });
}

double device_copy_bandwidth(Backend& backend, double working_set_bytes) {
    const double real_bytes = backend.describe().precision == Precision::single ? 4 : 8;
    const Index rows = static_cast<Index>(std::max(4096.0, working_set_bytes / (2 * real_bytes)));
    const auto from = backend.make_vector(rows, 1), to = backend.make_vector(rows, 1);
    const std::array<Index, 1> column = {0};
    backend.fill(*from, 1);
    const auto copy = [&](int repeats) {
        for (int i = 0; i < repeats; ++i) backend.copy_columns(*from, column, *to, column);
        backend.wait();
    };
    copy(1);  // builds the kernel
    return best_bandwidth(2 * real_bytes * rows, copy);
}

}  // namespace palpate::bench
