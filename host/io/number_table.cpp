// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/number_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_rows = 100000;
constexpr std::uintmax_t largest_table_bytes = 16 << 20;

[[noreturn]] void refuse_line(const std::string& file, std::size_t line, const std::string& why) {
    throw Error(ErrorCode::input_unreadable, fmt::format("{}, line {}: {}", file, line, why));
}

std::string_view trimmed(std::string_view text) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    for (;;) {
        const std::size_t comma = line.find(',');
        cells.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) return cells;
        line.remove_prefix(comma + 1);
    }
}

std::optional<double> number_of(std::string_view text) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_good =
        error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
    return is_good ? std::optional(value) : std::nullopt;
}

void read_header(NumberTable& table, const std::vector<std::string_view>& cells, std::size_t line) {
    table.header_line = line;
    table.columns.assign(cells.begin(), cells.end());
    for (const std::string& name : table.columns) {
        if (name.empty() || std::count(table.columns.begin(), table.columns.end(), name) > 1)
            refuse_line(table.source, line,
                        fmt::format("the column '{}' is empty or there twice; give each column a "
                                    "name of its own",
                                    name));
    }
    if (std::all_of(cells.begin(), cells.end(), [](auto cell) { return number_of(cell); }))
        refuse_line(table.source, line, "the first line holds numbers; put names of columns there");
}

void read_row(NumberTable& table, const std::vector<std::string_view>& cells, std::size_t line) {
    if (cells.size() != table.columns.size())
        refuse_line(table.source, line,
                    fmt::format("{} values for {} columns; give one for each, separated by commas",
                                cells.size(), table.columns.size()));
    if (table.rows.size() == most_rows)
        refuse_line(table.source, line, fmt::format("a table may have {} rows", most_rows));
    std::vector<double> values;
    for (const std::string_view cell : cells) {
        const auto value = number_of(cell);
        if (!value)
            refuse_line(table.source, line,
                        fmt::format("'{}' is not a number; use digits with a decimal point", cell));
        values.push_back(*value);
    }
    table.rows.push_back(std::move(values));
    table.lines.push_back(line);
}

}  // namespace

std::optional<std::size_t> NumberTable::find(std::string_view column) const {
    const auto at = std::find(columns.begin(), columns.end(), column);
    if (at == columns.end()) return std::nullopt;
    return static_cast<std::size_t>(at - columns.begin());
}

std::vector<double> NumberTable::values(std::string_view column) const {
    const auto k = find(column);
    if (!k)
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{} has no column '{}'; it has: {}", source, column,
                                fmt::join(columns, ", ")));
    std::vector<double> list;
    for (const auto& row : rows) list.push_back(row[*k]);
    return list;
}

void NumberTable::refuse_row(std::size_t row, const std::string& why) const {
    refuse_line(source, lines[row], why);
}

NumberTable parse_number_table(std::string_view text, const std::string& source_name) {
    NumberTable table;
    table.source = source_name;
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // some programs' mark of UTF-8
    for (std::size_t line = 1; !text.empty(); ++line) {
        const std::size_t end = text.find('\n');
        const std::string_view content = trimmed(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (content.empty() || content.front() == '#') continue;
        if (table.columns.empty())
            read_header(table, cells_of(content), line);
        else
            read_row(table, cells_of(content), line);
    }
    if (table.rows.empty())
        throw Error(ErrorCode::input_unreadable,
                    source_name + ": there is no row of numbers; give at least one");
    return table;
}

NumberTable read_number_table(const std::filesystem::path& path) {
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("cannot read the table '{}': {}", path.string(), why));
    };
    if (const auto why = why_unreadable(path)) refuse(*why + "; check the path");
    std::error_code failed;
    if (std::filesystem::file_size(path, failed) > largest_table_bytes)
        refuse("it is larger than 16 MiB; give fewer rows");
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    return parse_number_table(text, path.filename().string());
}

}  // namespace palpate
