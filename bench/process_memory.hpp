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

double available_memory_mib();  ///< what the machine could still give; 0 where /proc does not say

}  // namespace palpate::bench
