// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "solver/base/error.hpp"

namespace palpate {

/// Runs a parser on what the fuzzer made. It may take it or refuse it with an Error that blames the
/// input in words; anything else ends the program and is a finding.
template <typename Parse>
int fuzz_one(const Parse& parse) {
    try {
        parse();
    } catch (const Error& error) {
        const ErrorCode code = error.code();
        const bool blames_input = code == ErrorCode::input_unreadable ||
                                  code == ErrorCode::input_unusable ||
                                  code == ErrorCode::invalid_argument;
        if (!blames_input || std::string(error.what()).empty()) std::abort();
    }
    return 0;
}

inline std::vector<std::uint8_t> bytes_of(const std::uint8_t* data, std::size_t size) {
    return {data, data + size};
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

}  // namespace palpate
