// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/resident_memory.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace palpate {
namespace {

using Folder = std::filesystem::path;

/// Sum of `mb_of(folder in /proc)` over a process and all that it has started.
template <typename Of>
double sum_over_family(pid_t process, const Of& mb_of) {
    const Folder folder = "/proc/" + std::to_string(process);
    double mb = mb_of(folder);
    // Everything below may end while it is read.
    std::error_code gone;
    for (std::filesystem::directory_iterator thread(folder / "task", gone), end;
         !gone && thread != end; thread.increment(gone)) {
        std::ifstream children(thread->path() / "children");
        for (pid_t child = 0; children >> child;) mb += sum_over_family(child, mb_of);
    }
    return mb;
}

/// Pages over how many processes have them.
double proportional_mb(const Folder& process) {
    std::ifstream sums(process / "smaps_rollup");
    for (std::string line; std::getline(sums, line);)
        if (line.starts_with("Pss:")) return std::stod(line.substr(4)) * 1024 / 1e6;
    return 0;
}

/// Pages, whoever else has them: never less.
double whole_mb(const Folder& process) {
    std::ifstream counts(process / "statm");
    double mapped = 0, resident = 0;
    counts >> mapped >> resident;
    return resident * double(::sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace

double resident_mb(pid_t process) { return sum_over_family(process, proportional_mb); }

bool holds_more_than(pid_t process, double mb) {
    return sum_over_family(process, whole_mb) > mb && resident_mb(process) > mb;
}

}  // namespace palpate
