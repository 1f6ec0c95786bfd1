// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/memory_limit.hpp"

#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "host/system/interrupt.hpp"
#include "solver/backend/registry.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t mib = std::size_t(1) << 20;
constexpr std::size_t blas_buffer = 136 * mib;  ///< of address space, hardly any of it used
constexpr std::size_t least_work = 128 * mib;   ///< beyond those buffers
constexpr std::size_t little = 512 * mib;       ///< libraries ask for blocks of this size at once

/// MiB; 0: none.
std::size_t limit_mib() {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return 0;
    return std::max<std::size_t>(1, limit.rlim_cur / mib);
}

bool can_have(std::size_t bytes) {
    void* memory =
        mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) return false;
    munmap(memory, bytes);
    return true;
}

/// OpenBLAS keeps what was taken and given back. Another BLAS has no such functions.
void reserve_blas_buffers(std::size_t count) {
    const auto take = reinterpret_cast<void* (*)(int)>(dlsym(RTLD_DEFAULT, "blas_memory_alloc"));
    const auto give_back =
        reinterpret_cast<void (*)(void*)>(dlsym(RTLD_DEFAULT, "blas_memory_free"));
    if (!take || !give_back) return;
    std::vector<void*> buffers;
    for (std::size_t k = 0; k < count; ++k) buffers.push_back(take(0));
    for (void* buffer : buffers) give_back(buffer);
}

std::string& last_words() {
    static std::string text;
    return text;
}

/// Of address space; 0 if that cannot be told. As all that crashes call, safe in signal handlers.
std::size_t mapped_bytes() {
    char text[64];
    const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (file < 0) return 0;
    const ssize_t length = read(file, text, sizeof text);
    close(file);
    std::size_t pages = 0;
    for (ssize_t k = 0; k < length && text[k] >= '0' && text[k] <= '9'; ++k)
        pages = 10 * pages + static_cast<std::size_t>(text[k] - '0');
    return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

bool is_memory_short() {
    rlimit limit{};
    return getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
           mapped_bytes() + little > limit.rlim_cur;
}

/// A crash with enough memory left has another cause: the system tells it in its own way.
void end_with_last_words(int signal) {
    if (!is_memory_short()) {
        std::signal(signal, SIG_DFL);
        raise(signal);  // takes effect at the return
        return;
    }
    const std::string& text = last_words();
    const ssize_t ignored = write(STDERR_FILENO, text.data(), text.size());
    _exit(ignored < 0 ? 1 : exit_code_of(ErrorCode::out_of_memory));
}

/// The C library looks for it when the first thread is cancelled, and says so on standard error
/// where no memory is left for that.
void load_unwinder() {
    void* frame = nullptr;
    backtrace(&frame, 1);
}

/// Drivers install handlers of their own when they are looked for first.
void look_for_devices() {
    for (const BackendEntry& entry : backend_registry()) {
        try {
            entry.devices();
        } catch (const Error&) {
            continue;  // told when a device is asked for
        }
    }
}

void tell_crashes(std::size_t limit) {
    last_words() = fmt::format(
        "{}: a library ended the program, most likely because the limit of {} MiB of address "
        "space is too small; raise it (ulimit -v), or use fewer --nodes\n",
        program_name(), limit);
    for (const int signal : {SIGABRT, SIGBUS, SIGSEGV}) std::signal(signal, end_with_last_words);
}

}  // namespace

void prepare_for_memory_limit() {
    const std::size_t limit = limit_mib();
    if (limit == 0) return;
    const std::size_t count = std::max(1u, std::thread::hardware_concurrency()) + 1;
    if (!can_have(count * blas_buffer + least_work))
        throw Error(
            ErrorCode::out_of_memory,
            fmt::format("the limit of {} MiB of address space is too small; raise it (ulimit "
                        "-v) by {} MiB",
                        limit, (count * blas_buffer + least_work) / mib));
    load_unwinder();
    reserve_blas_buffers(count);
    tell_crashes(limit);
    look_for_devices();
    tell_crashes(limit);
}

void end_program(int code) {
    if (limit_mib() == 0) std::exit(code);
    std::fflush(nullptr);
    std::quick_exit(code);
}

}  // namespace palpate
