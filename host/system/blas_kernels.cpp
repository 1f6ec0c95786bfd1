// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/blas_kernels.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace palpate {
namespace {

constexpr const char* kernel_choice = "OPENBLAS_CORETYPE";

/// The kernels in use; empty: another BLAS.
std::string_view kernels_in_use() {
    const auto name = reinterpret_cast<char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
    return name ? name() : "";
}

/// Of those that OpenBLAS has; null: none beyond the oldest.
const char* fastest_kernels() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
        return "SkylakeX";
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
#endif
    return nullptr;
}

}  // namespace

void take_fast_blas_kernels(char** arguments) {
    if (std::getenv(kernel_choice) || kernels_in_use() != "Prescott") return;
    const char* kernels = fastest_kernels();
    std::error_code none;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", none);
    if (none || !kernels || setenv(kernel_choice, kernels, 1) != 0) return;
    execv(program.c_str(), arguments);  // where that fails, it goes on slowly
}

}  // namespace palpate
