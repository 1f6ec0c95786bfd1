// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/pipeline/version.hpp"

namespace palpate {

std::string version_text() { return PALPATE_VERSION; }

}  // namespace palpate
