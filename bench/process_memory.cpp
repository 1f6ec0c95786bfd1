// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/process_memory.hpp"

#include <malloc.h>
#include <sys/resource.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace palpate::bench {
namespace {

double status_mib(const std::string& key) {
    std::ifstream file("/proc/self/status");
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

double memory_mib() { return status_mib("VmRSS:"); }
double peak_memory_mib() { return status_mib("VmHWM:"); }

void limit_memory_from_environment() {
    const char* text = std::getenv("PALPATE_BENCH_MEMORY_GIB");
    const double gib = text ? std::atof(text) : 0;
    if (!(gib > 0)) return;
    rlimit limit{};
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = static_cast<rlim_t>(gib * (1 << 30));
    setrlimit(RLIMIT_AS, &limit);
}

}  // namespace palpate::bench
