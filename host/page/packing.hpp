// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace palpate {

/// Base64 (RFC 4648, with padding) of raw bytes.
std::string to_base64(std::span<const std::uint8_t> bytes);

/// Little-endian typed arrays as the scripts read them: fp32 (not finite becomes 0) and uint32.
std::string pack_floats(const std::vector<double>& values);
std::string pack_indices(const std::vector<std::uint32_t>& values);

/// Run lengths: each run is one value byte and its length as LEB128 (7 bits a byte, low first).
std::vector<std::uint8_t> run_lengths(const std::vector<std::uint8_t>& values);

}  // namespace palpate
