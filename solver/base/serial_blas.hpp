// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#if defined(__GNUC__) && defined(__ELF__)
// OpenBLAS has them, other BLAS do not: null there.
extern "C" {
__attribute__((weak)) int openblas_get_num_threads();
__attribute__((weak)) void openblas_set_num_threads(int);
}
#define PALPATE_KNOWS_OPENBLAS
#endif

namespace palpate {

/// While one of these lives, OpenBLAS computes on the thread that calls it. To be held round work
/// that is shared among threads already: they would queue for the threads of BLAS, which made the
/// direct solve of many columns almost three times slower on two cores. Any number at a time; it
/// holds for the whole process.
class SerialBlas {
public:
    SerialBlas() {
#ifdef PALPATE_KNOWS_OPENBLAS
        State& state = shared();
        const std::lock_guard lock(state.mutex);
        if (state.holders++ > 0 || !openblas_set_num_threads) return;
        state.num_threads = openblas_get_num_threads();
        openblas_set_num_threads(1);
#endif
    }
    ~SerialBlas() {
#ifdef PALPATE_KNOWS_OPENBLAS
        State& state = shared();
        const std::lock_guard lock(state.mutex);
        if (--state.holders > 0 || !openblas_set_num_threads) return;
        openblas_set_num_threads(state.num_threads);
#endif
    }
    SerialBlas(const SerialBlas&) = delete;
    SerialBlas& operator=(const SerialBlas&) = delete;

private:
    struct State {
        std::mutex mutex;
        int holders = 0;
        int num_threads = 1;
    };
    static State& shared() {
        static State state;
        return state;
    }
};

}  // namespace palpate

#undef PALPATE_KNOWS_OPENBLAS
