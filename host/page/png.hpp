// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// The bytes of a PNG file of 8-bit grey pixels, rows from the top; it holds nothing else.
std::vector<std::uint8_t> png_of(Index width, Index height, std::span<const std::uint8_t> pixels);

}  // namespace palpate
