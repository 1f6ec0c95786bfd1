// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/resident_memory.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace palpate {

double resident_mb(pid_t process) {
    const std::filesystem::path folder = "/proc/" + std::to_string(process);
    // Pss: pages over how many processes have them
    double mb = 0;
    std::ifstream sums(folder / "smaps_rollup");
    for (std::string line; std::getline(sums, line);)
        if (line.starts_with("Pss:")) mb = std::stod(line.substr(4)) * 1024 / 1e6;
    // Everything below may end while it is read.
    std::error_code gone;
    for (std::filesystem::directory_iterator thread(folder / "task", gone), end;
         !gone && thread != end; thread.increment(gone)) {
        std::ifstream children(thread->path() / "children");
        for (pid_t child = 0; children >> child;) mb += resident_mb(child);
    }
    return mb;
}

}  // namespace palpate
