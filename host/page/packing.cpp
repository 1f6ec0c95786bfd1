// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/packing.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate {
namespace {

void append_little_endian(std::vector<std::uint8_t>& bytes, std::uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back((word >> shift) & 0xff);
}

}  // namespace

std::string to_base64(std::span<const std::uint8_t> bytes) {
    static constexpr char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0);
        for (std::size_t k = 0; k < 4; ++k)
            out += k <= count ? letters[(word >> (18 - 6 * k)) & 63] : '=';
    }
    return out;
}

std::string pack_floats(const std::vector<double>& values) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(4 * values.size());
    for (double v : values) {
        const float single = std::isfinite(v) ? static_cast<float>(v) : 0.0f;
        append_little_endian(bytes, std::bit_cast<std::uint32_t>(single));
    }
    return to_base64(bytes);
}

std::string pack_indices(const std::vector<std::uint32_t>& values) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(4 * values.size());
    for (std::uint32_t v : values) append_little_endian(bytes, v);
    return to_base64(bytes);
}

ScaledNumbers pack_scaled(const std::vector<double>& values) {
    constexpr double most_steps = 65534;
    constexpr std::uint32_t missing = 65535;
    ScaledNumbers numbers{INFINITY, -INFINITY, ""};
    for (const double v : values) {
        if (!std::isfinite(v)) continue;
        numbers.low = std::min(numbers.low, v);
        numbers.high = std::max(numbers.high, v);
    }
    if (numbers.low > numbers.high) numbers.low = numbers.high = 0;
    const double range = numbers.high - numbers.low;
    std::vector<std::uint8_t> bytes;
    bytes.reserve(2 * values.size());
    for (const double v : values) {
        const double steps = range > 0 ? std::round(most_steps * ((v - numbers.low) / range)) : 0;
        const std::uint32_t word = std::isfinite(v) ? static_cast<std::uint32_t>(steps) : missing;
        for (const int shift : {0, 8}) bytes.push_back((word >> shift) & 0xff);
    }
    numbers.packed = to_base64(bytes);
    return numbers;
}

std::vector<std::uint8_t> run_lengths(const std::vector<std::uint8_t>& values) {
    std::vector<std::uint8_t> out;
    for (std::size_t i = 0; i < values.size();) {
        std::size_t end = i;
        while (end < values.size() && values[end] == values[i]) ++end;
        out.push_back(values[i]);
        std::size_t length = end - i;
        for (; length > 127; length >>= 7) out.push_back(0x80 | (length & 0x7f));
        out.push_back(static_cast<std::uint8_t>(length));
        i = end;
    }
    return out;
}

}  // namespace palpate
