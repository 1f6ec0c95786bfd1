// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/process_memory.hpp"

#include <malloc.h>

#include <fstream>
#include <string>

namespace palpate::bench {
namespace {

/// The number of KiB that follows `key` in a file of /proc, as MiB.
double mib_in(const char* path, const std::string& key) {
    std::ifstream file(path);
    for (std::string word; file >> word;) {
        double kib = 0;
        if (word == key && file >> kib) return kib / 1024;
    }
    return 0;
}

}  // namespace

void reset_peak_memory() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5\n";
}

double memory_mib() { return mib_in("/proc/self/status", "VmRSS:"); }
double peak_memory_mib() { return mib_in("/proc/self/status", "VmHWM:"); }
double available_memory_mib() { return mib_in("/proc/meminfo", "MemAvailable:"); }

}  // namespace palpate::bench
