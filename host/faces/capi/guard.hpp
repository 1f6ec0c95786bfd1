// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "host/faces/capi/palpate.h"
#include "solver/base/error.hpp"
#include "solver/base/log.hpp"

// The border between C++ and C: nothing is thrown across it.
namespace palpate::capi {

/// What `palpate_last_error` gives on this thread.
std::string& last_error();

palpate_status status_of(ErrorCode code);

/// Calls `work`, which returns a status, and turns what it throws into one.
template <class Work>
palpate_status guarded(Work&& work) noexcept {
    try {
        return work();
    } catch (const Error& error) {
        last_error() = error.what();
        return status_of(error.code());
    } catch (const std::bad_alloc&) {
        last_error() = "out of memory";
        return PALPATE_DEVICE_FAILED;
    } catch (const std::exception& error) {
        last_error() = std::string("internal error: ") + error.what();
        return PALPATE_INTERNAL;
    } catch (...) {
        last_error() = "internal error of an unknown kind";
        return PALPATE_INTERNAL;
    }
}

/// Throws Error(invalid_argument) if `pointer` is null.
void require(const void* pointer, const char* what);

/// A caller's struct, which may be older and shorter or newer and longer than ours: what it does
/// not have keeps the default. Throws Error(invalid_argument) if it is null or was not initialised.
template <class Struct>
Struct completed(const Struct* given, void (*init)(Struct*), const char* what) {
    require(given, what);
    constexpr std::size_t largest = 4096;
    const std::size_t size = given->struct_size;
    if (size < sizeof(std::size_t) || size > largest)
        throw Error(
            ErrorCode::invalid_argument,
            std::string(what) + " was not initialised: its struct_size is " + std::to_string(size));
    Struct full;
    init(&full);
    std::memcpy(&full, given, std::min(size, sizeof(Struct)));
    full.struct_size = sizeof(Struct);
    return full;
}

/// A sink that calls back, and throws Error(cancelled) when the answer is not 0. Reports without
/// news repeat the last stage, at most ten times a second. Empty for null.
ProgressSink progress_sink(palpate_progress callback, void* user);

}  // namespace palpate::capi
