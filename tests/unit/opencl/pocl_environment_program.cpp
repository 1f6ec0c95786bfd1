// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "solver/backends/opencl/opencl_backend.hpp"
#include "solver/backends/opencl/opencl_devices.hpp"

// For pocl_environment_test.cpp, as the environment belongs to a process: prints what PoCL sees.
int main() {
    palpate::opencl_devices();
    const char* folder = std::getenv("POCL_CACHE_DIR");
    if (!folder || !std::filesystem::is_directory(folder)) return 1;
    std::puts(folder);
    std::puts(std::getenv("POCL_WORK_GROUP_SPECIALIZATION"));
    return 0;
}
