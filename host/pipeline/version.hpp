// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate {

/// "0.1.0", from the build system.
std::string version_text();

}  // namespace palpate
