// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/row.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "host/io/delimited_text.hpp"
#include "solver/base/error.hpp"

namespace palpate {
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
    std::string out = delimited_line(columns, ',');
    for (const Row& row : rows) {
        std::vector<std::string> cells;
        for (const std::string& column : columns) cells.push_back(row.text(column));
        out += delimited_line(cells, ',');
    }
    return out;
}

std::vector<Row> parse_csv(const std::string& text, const std::string& source) {
    const DelimitedText table = parse_delimited(text, {.separator = ',', .takes_any_text = true});
    for (const TableFault& fault : table.faults) {
        if (fault.line == 0) return {};  // nothing was written yet
        const std::string what =
            fault.num_values > 0
                ? fmt::format("has {} values in line {}, but {} columns", fault.num_values,
                              fault.line, table.columns.size())
                : fmt::format("is damaged in line {}: {}", fault.line, fault.sentence);
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{} {}; mend it, or add --overwrite to begin again", source, what));
    }
    std::vector<Row> rows;
    for (const std::vector<std::string>& cells : table.rows) {
        Row row;
        for (std::size_t c = 0; c < cells.size(); ++c) row.set(table.columns[c], cells[c]);
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace palpate
