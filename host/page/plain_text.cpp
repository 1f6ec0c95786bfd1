// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/plain_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

/// Characters of UTF-8 text: every byte but the continuation bytes.
std::size_t width_of(const std::string& text) {
    return std::count_if(text.begin(), text.end(),
                         [](unsigned char c) { return (c & 0xc0) != 0x80; });
}

std::string rule(const std::vector<std::size_t>& widths) {
    std::string out;
    for (std::size_t w : widths) out += std::string(w, '-') + "  ";
    return out.substr(0, out.size() - 2) + '\n';
}

}  // namespace

std::string harmless(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return text;
}

std::string csv_number(double value) {
    return std::isfinite(value) ? fmt::format("{}", value) : "";
}

std::string csv_text(const std::string& text) {
    std::string out = "\"";
    for (char c : harmless(text)) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + '"';
}

TextTable::TextTable(std::vector<std::string> header, std::vector<bool> to_the_right)
    : rows_{std::move(header)}, to_the_right_(std::move(to_the_right)) {}

std::string TextTable::text() const {
    std::vector<std::size_t> widths(to_the_right_.size(), 0);
    for (const auto& row : rows_)
        for (std::size_t c = 0; c < widths.size(); ++c)
            widths[c] = std::max(widths[c], width_of(row[c]));
    std::string out;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        out += line(rows_[r], widths);
        if (r == 0) out += rule(widths);
    }
    return out;
}

std::string TextTable::line(const std::vector<std::string>& row,
                            const std::vector<std::size_t>& widths) const {
    std::string out;
    for (std::size_t c = 0; c < widths.size(); ++c) {
        const std::string blanks(widths[c] - width_of(row[c]), ' ');
        out += to_the_right_[c] ? blanks + row[c] : row[c] + blanks;
        out += "  ";
    }
    return out.substr(0, out.find_last_not_of(' ') + 1) + '\n';
}

}  // namespace palpate
