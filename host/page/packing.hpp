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

/// Numbers of 16 bits between the smallest and the largest, little-endian, in steps of 1/65534 of
/// that range; 65535 stands for one that is not finite.
struct ScaledNumbers {
    double low = 0, high = 0;
    std::string packed;
};
ScaledNumbers pack_scaled(const std::vector<double>& values);

/// Run lengths: each run is one value byte and its length as LEB128 (7 bits a byte, low first).
std::vector<std::uint8_t> run_lengths(const std::vector<std::uint8_t>& values);

}  // namespace palpate
