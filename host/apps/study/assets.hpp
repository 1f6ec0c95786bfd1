// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace palpate {

/// Files of `assets/`, compiled in (EmbedText.cmake). The page uses the report's style sheet too.
std::string_view study_css();

}  // namespace palpate
