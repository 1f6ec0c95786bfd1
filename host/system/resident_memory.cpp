// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/resident_memory.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

namespace palpate {

double resident_mb(pid_t process) {
    const std::filesystem::path folder = "/proc/" + std::to_string(process);
    double all_pages = 0, pages = 0;
    std::ifstream(folder / "statm") >> all_pages >> pages;
    double mb = pages * double(::sysconf(_SC_PAGESIZE)) / 1e6;
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
