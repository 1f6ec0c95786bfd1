// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace palpate {

/// Text made safe as HTML content and as an attribute in double quotes; control characters and
/// broken UTF-8 become U+FFFD.
std::string escape_html(std::string_view text);

/// JSON that may stand inside a <script> element: "<" is escaped.
std::string script_json(std::string_view json);

/// Replaces each {{name}} of the template by its value, once: values are not searched again.
/// Throws Error(internal) for a name without value.
std::string fill_template(std::string_view text, const std::map<std::string, std::string>& values);

/// Colour number `position` of lists, "#rrggbb", told apart by colour-blind readers; repeats.
std::string list_colour(std::size_t position);

/// Of what is given or held, as CSS.
inline constexpr const char* neutral_colour = "#8b939b";

}  // namespace palpate
