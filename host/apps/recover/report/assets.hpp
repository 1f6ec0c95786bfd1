// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace palpate {

/// Files of `assets/`, compiled in (EmbedText.cmake).
std::string_view report_html_template();
std::string_view report_js();

}  // namespace palpate
