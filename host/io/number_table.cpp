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
#include <limits>

#include "host/io/delimited_text.hpp"
#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::uintmax_t bytes_per_row = 160;

[[noreturn]] void refuse_line(const std::string& file, std::size_t line, const std::string& why) {
    throw Error(ErrorCode::input_unreadable, fmt::format("{}, line {}: {}", file, line, why));
}

std::optional<double> number_of(std::string_view text) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_good =
        error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
    return is_good ? std::optional(value) : std::nullopt;
}

void read_header(NumberTable& table, const DelimitedText& read) {
    table.header_line = read.header_line;
    table.columns = read.columns;
    for (const std::string& name : table.columns) {
        if (name.empty() || std::count(table.columns.begin(), table.columns.end(), name) > 1)
            refuse_line(table.source, table.header_line,
                        fmt::format("the column '{}' is empty or there twice; give each column a "
                                    "name of its own",
                                    name));
    }
    if (std::all_of(table.columns.begin(), table.columns.end(),
                    [](const std::string& name) { return number_of(name); }))
        refuse_line(table.source, table.header_line,
                    "the first line holds numbers; put names of columns there");
}

void read_row(NumberTable& table, const std::vector<std::string>& cells, std::size_t line,
              std::size_t most_rows) {
    if (table.rows.size() == most_rows)
        refuse_line(table.source, line, fmt::format("a table may have {} rows", most_rows));
    std::vector<double> values;
    for (const std::string& cell : cells) {
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

NumberTable parse_number_table(std::string_view text, const std::string& source_name,
                               std::size_t most_rows) {
    NumberTable table;
    table.source = source_name;
    const DelimitedText read = parse_delimited(text, {',', true});
    if (!read.columns.empty()) read_header(table, read);
    // The first line that is wrong is told.
    const auto refuse_before = [&](std::size_t line) {
        if (!read.faults.empty() && read.faults.front().line > 0 && read.faults.front().line < line)
            refuse_line(source_name, read.faults.front().line, read.faults.front().sentence);
    };
    for (std::size_t k = 0; k < read.rows.size(); ++k) {
        refuse_before(read.lines[k]);
        read_row(table, read.rows[k], read.lines[k], most_rows);
    }
    refuse_before(std::numeric_limits<std::size_t>::max());
    if (table.rows.empty())
        throw Error(ErrorCode::input_unreadable,
                    source_name + ": there is no row of numbers; give at least one");
    return table;
}

NumberTable read_number_table(const std::filesystem::path& path, std::size_t most_rows) {
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("cannot read the table '{}': {}", path.string(), why));
    };
    if (const auto why = why_unreadable(path)) refuse(*why + "; check the path");
    std::error_code failed;
    const std::uintmax_t most_bytes = bytes_per_row * most_rows;
    if (std::filesystem::file_size(path, failed) > most_bytes)
        refuse(fmt::format("it is larger than {} MiB; give fewer rows", most_bytes >> 20));
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    return parse_number_table(text, path.filename().string(), most_rows);
}

}  // namespace palpate
