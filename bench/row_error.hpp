// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmark/benchmark.h>

#include <exception>
#include <string>

#include "solver/base/error.hpp"

namespace palpate::bench {

/// Ends a row whose answer is wrong: tests look for the word "failed".
inline void fail_row(benchmark::State& state, const std::string& why) {
    state.SkipWithError(("failed: " + why).c_str());
}

/// Ends a row that cannot be timed here, with the reason: no device, no mesh file, not in this
/// build, too large. Any other error is a failure.
inline void skip_row(benchmark::State& state, const std::exception& why) {
    const auto* error = dynamic_cast<const Error*>(&why);
    const bool is_skipped = error && (error->code() == ErrorCode::unsupported ||
                                      error->code() == ErrorCode::device_unavailable ||
                                      error->code() == ErrorCode::input_unreadable ||
                                      error->code() == ErrorCode::out_of_memory);
    if (is_skipped || dynamic_cast<const std::bad_alloc*>(&why))
        state.SkipWithError((std::string("skipped: ") + why.what()).c_str());
    else
        fail_row(state, why.what());
}

}  // namespace palpate::bench
