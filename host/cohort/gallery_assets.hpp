// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace palpate {

/// Files of `assets/`, compiled in (EmbedText.cmake).
std::string_view gallery_css();
std::string_view gallery_js();
std::string_view gallery_help_html();
std::string_view gallery_body_html();

}  // namespace palpate
