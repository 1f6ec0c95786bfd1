// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate {

/// "0.1.0", from the build system.
std::string version_text();
/// Which factorisation is inside and under which licence the program may therefore be passed on, a
/// line each.
std::string build_text();

}  // namespace palpate
