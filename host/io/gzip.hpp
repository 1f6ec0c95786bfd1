// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

bool is_gzip(std::span<const std::uint8_t> bytes);

/// The first `count` bytes (or fewer) of a compressed stream, unchecked: for reading a header.
std::vector<std::uint8_t> inflated_start(std::span<const std::uint8_t> bytes, std::size_t count);

/// The whole content of a gzip or zlib stream (several gzip members are joined), with its checksum
/// and length verified.
/// Throws Error(input_unreadable) with a reason, without file name, if the stream is cut off or
/// damaged, is followed by other data, or holds more than `most` bytes (found out without storing
/// them).
std::vector<std::uint8_t> inflated(std::span<const std::uint8_t> bytes, std::size_t most);

/// One gzip member (some readers stop after the first) that holds `bytes`: not the smallest, but
/// quick to make (some 200 MB/s).
std::vector<std::uint8_t> gzipped(std::span<const std::uint8_t> bytes);

}  // namespace palpate
