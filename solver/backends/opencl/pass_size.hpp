// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace palpate {

constexpr std::size_t max_pass_columns = 16;  ///< columns whose element forces are held at a time
constexpr std::size_t gathered_reals = 72;    ///< some 24 corners of 3 reals per node

}  // namespace palpate
