// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/row.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

using Cells = std::vector<std::string>;

/// Lines of values; a quoted value may hold commas, doubled quotes and line ends.
std::vector<Cells> split_csv(const std::string& text) {
    std::vector<Cells> lines;
    Cells cells;
    std::string cell;
    bool is_quoted = false;
    const auto end_cell = [&] { cells.push_back(std::exchange(cell, {})); };
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (is_quoted) {
            if (c != '"') {
                cell += c;
            } else if (i + 1 < text.size() && text[i + 1] == '"') {
                cell += text[++i];
            } else {
                is_quoted = false;
            }
        } else if (c == '"') {
            is_quoted = true;
        } else if (c == ',') {
            end_cell();
        } else if (c == '\n') {
            end_cell();
            lines.push_back(std::exchange(cells, {}));
        } else if (c != '\r') {
            cell += c;
        }
    }
    if (!cell.empty() || !cells.empty()) {
        end_cell();
        lines.push_back(cells);
    }
    return lines;
}

}  // namespace

void Row::set(const std::string& name, const std::string& text) {
    const auto at = std::find_if(values_.begin(), values_.end(),
                                 [&](const auto& value) { return value.first == name; });
    if (at == values_.end())
        values_.emplace_back(name, text);
    else
        at->second = text;
}

void Row::set(const std::string& name, double value, int decimals) {
    set(name, std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : std::string());
}

void Row::set_flag(const std::string& name, bool value) {
    set(name, std::string(value ? "yes" : "no"));
}

bool Row::has(const std::string& name) const { return !text(name).empty(); }

const std::string& Row::text(const std::string& name) const {
    static const std::string none;
    for (const auto& [key, value] : values_)
        if (key == name) return value;
    return none;
}

double Row::number(const std::string& name) const {
    const std::string& value = text(name);
    double number = std::numeric_limits<double>::quiet_NaN();
    const auto parsed = std::from_chars(value.data(), value.data() + value.size(), number);
    return parsed.ptr == value.data() + value.size() ? number
                                                     : std::numeric_limits<double>::quiet_NaN();
}

bool Row::flag(const std::string& name) const { return text(name) == "yes"; }

std::string to_csv(const std::vector<std::string>& columns, const std::vector<Row>& rows) {
    std::string out = fmt::format("{}\n", fmt::join(columns, ","));
    for (const Row& row : rows) {
        Cells cells;
        for (const std::string& column : columns) cells.push_back(quoted(row.text(column)));
        out += fmt::format("{}\n", fmt::join(cells, ","));
    }
    return out;
}

std::vector<Row> parse_csv(const std::string& text, const std::string& source) {
    const std::vector<Cells> lines = split_csv(text);
    std::vector<Row> rows;
    for (std::size_t line = 1; line < lines.size(); ++line) {
        if (lines[line].size() != lines[0].size()) {
            throw Error(ErrorCode::input_unreadable,
                        fmt::format("{} has {} values in line {}, but {} columns; mend it, or add "
                                    "--overwrite to begin again",
                                    source, lines[line].size(), line + 1, lines[0].size()));
        }
        Row row;
        for (std::size_t c = 0; c < lines[0].size(); ++c) row.set(lines[0][c], lines[line][c]);
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace palpate
