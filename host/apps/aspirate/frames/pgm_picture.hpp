// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/aspirate/contours/outline.hpp"

namespace palpate {

/// A grey picture in the format PGM (P5, 8 or 16 bits), white as 255; its largest value into
/// `depth`. Throws Error(input_unreadable), without the file's name.
GreyFrame parse_pgm(const std::vector<char>& bytes, Index& depth);

}  // namespace palpate
