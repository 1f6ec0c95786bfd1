// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/markup.hpp"

#include <array>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr const char* replacement = "\xef\xbf\xbd";  // U+FFFD in UTF-8
/// After Okabe and Ito (2008), the blue lightened and the yellow darkened for dark and light paper.
constexpr std::array<const char*, 7> palette{"#d55e00", "#2f86c9", "#009e73", "#cc79a7",
                                             "#c79a00", "#56b4e9", "#8a63c9"};

/// Bytes of the UTF-8 character at the front of `text`, 0 if it is not valid.
std::size_t character_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char first = byte(0);
    const std::size_t length = first < 0x80                    ? 1
                               : first >= 0xc2 && first < 0xe0 ? 2
                               : first >= 0xe0 && first < 0xf0 ? 3
                               : first >= 0xf0 && first < 0xf5 ? 4
                                                               : 0;
    if (length == 0 || length > text.size()) return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    return length;
}

std::string_view escaped_ascii(const char& c) {
    switch (c) {
        case '&':
            return "&amp;";
        case '<':
            return "&lt;";
        case '>':
            return "&gt;";
        case '"':
            return "&quot;";
        case '\'':
            return "&#39;";
        case '\n':
        case '\t':
            return {&c, 1};
        default:
            break;
    }
    const auto code = static_cast<unsigned char>(c);
    return code < 0x20 || code == 0x7f ? std::string_view(replacement) : std::string_view(&c, 1);
}

}  // namespace

std::string escape_html(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        if (length == 0)
            out += replacement;
        else if (length == 1)
            out += escaped_ascii(text.front());
        else
            out += text.substr(0, length);
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return out;
}

/// "</script" and "<!--" must not occur there.
std::string script_json(std::string_view json) {
    std::string out;
    out.reserve(json.size());
    for (const char c : json) out += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return out;
}

std::string fill_template(std::string_view text, const std::map<std::string, std::string>& values) {
    std::string out;
    for (;;) {
        const std::size_t open = text.find("{{");
        if (open == std::string_view::npos) return out += text;
        const std::size_t close = text.find("}}", open);
        const std::string name{text.substr(open + 2, close - open - 2)};
        const auto value = values.find(name);
        if (close == std::string_view::npos || value == values.end())
            throw Error(ErrorCode::internal, "report template: no value for {{" + name + "}}");
        out += text.substr(0, open);
        out += value->second;
        text.remove_prefix(close + 2);
    }
}

std::string list_colour(std::size_t position) { return palette[position % palette.size()]; }

}  // namespace palpate
