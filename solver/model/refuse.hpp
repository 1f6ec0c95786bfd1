// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "solver/base/error.hpp"

namespace palpate {

/// Throws Error(invalid_argument).
[[noreturn]] inline void refuse(const std::string& message) {
    throw Error(ErrorCode::invalid_argument, message);
}

}  // namespace palpate
