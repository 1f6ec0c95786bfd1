// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::bench {

/// Gives freed memory back to the system and starts the peak anew from what is in use; where the
/// kernel does not allow it, peaks of earlier cases stay: run one case per process
/// (--benchmark_filter).
void reset_peak_memory();

double memory_mib();       ///< resident now; 0 where /proc does not say
double peak_memory_mib();  ///< largest resident since the reset

/// Limits this process to the number of GiB in the environment variable
/// PALPATE_BENCH_MEMORY_GIB, so that a solver that asks for more is skipped rather than the machine
/// brought down. Address space is what counts: ask for a few GiB more than a GPU driver maps.
void limit_memory_from_environment();

}  // namespace palpate::bench
