// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/load_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/io/files.hpp"
#include "host/io/number_table.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_rows = 100000;
constexpr std::string_view time_column = "time_s";

/// Checks one more row against those before and adds it; why not, or nothing.
std::optional<std::string> add_row(LoadTable& table, double time_s, std::vector<double> factors) {
    if (time_s == 0 && table.time_s.empty()) {
        if (std::all_of(factors.begin(), factors.end(), [](double f) { return f == 0; }))
            return std::nullopt;
        return "a row at time 0 must be 0 in every column, because the body is then at rest; begin "
               "with a small time instead";
    }
    const double before = table.time_s.empty() ? 0 : table.time_s.back();
    if (!(time_s > before))
        return fmt::format("times must ascend from above 0 s; there is {} after {}", time_s,
                           before);
    if (table.time_s.size() == most_rows)
        return fmt::format("a load history may have {} rows; give fewer", most_rows);
    table.time_s.push_back(time_s);
    table.factors.push_back(std::move(factors));
    return std::nullopt;
}

/// The table as factors over time; the first column is the time.
LoadTable factors_of(const NumberTable& numbers) {
    if (numbers.columns.front() != time_column)
        throw Error(
            ErrorCode::input_unreadable,
            fmt::format("{}, line {}: the first column must be '{}', not '{}'; name the columns in "
                        "the first line",
                        numbers.source, numbers.header_line, time_column, numbers.columns.front()));
    LoadTable table;
    table.columns.assign(numbers.columns.begin() + 1, numbers.columns.end());
    for (std::size_t row = 0; row < numbers.rows.size(); ++row) {
        const std::vector<double>& values = numbers.rows[row];
        if (const auto why = add_row(table, values[0], {values.begin() + 1, values.end()}))
            numbers.refuse_row(row, *why);
    }
    if (table.time_s.empty())
        throw Error(ErrorCode::input_unreadable,
                    numbers.source + ": there is no row above time 0; give at least one");
    return table;
}

LoadTable read_file(const SettingsTable& table, const fs::path& folder) {
    for (const std::string& key : table.keys())
        if (key != "file" && key != "longest_step_s")
            table.refuse(key, "allowed beside 'file': longest_step_s; put columns into the file");
    const fs::path path = folder / *table.text("file");
    if (const auto why = why_unreadable(path))
        table.refuse("file", fmt::format("it cannot be read because {}; check the path", *why));
    return factors_of(read_number_table(path));
}

LoadTable read_lists(const SettingsTable& table) {
    const auto times = table.numbers(time_column, 1, most_rows);
    if (!times) table.missing(time_column, "a list of times in s, or a 'file' with such a column");
    LoadTable history;
    std::vector<std::vector<double>> lists;
    for (const std::string& key : table.keys()) {
        if (key == time_column || key == "longest_step_s") continue;
        history.columns.push_back(key);
        lists.push_back(*table.numbers(key, times->size(), times->size()));
    }
    for (std::size_t row = 0; row < times->size(); ++row) {
        std::vector<double> factors;
        for (const auto& list : lists) factors.push_back(list[row]);
        if (const auto why = add_row(history, (*times)[row], std::move(factors)))
            table.refuse(time_column, *why);
    }
    return history;
}

/// Rows put between those there are, so that no step is longer.
LoadTable refined(const LoadTable& table, double longest_step_s) {
    LoadTable fine{table.columns, {}, {}};
    double before_s = 0;
    std::vector<double> before(table.columns.size(), 0.0);
    for (std::size_t row = 0; row < table.time_s.size(); ++row) {
        const double span_s = table.time_s[row] - before_s;
        const double count = std::ceil(span_s / longest_step_s * (1 - 1e-9));
        for (double k = 1; k <= count; ++k) {
            std::vector<double> factors;
            for (std::size_t c = 0; c < before.size(); ++c)
                factors.push_back(before[c] + k / count * (table.factors[row][c] - before[c]));
            fine.time_s.push_back(before_s + k / count * span_s);
            fine.factors.push_back(std::move(factors));
        }
        before_s = fine.time_s.back() = table.time_s[row];
        before = table.factors[row];
    }
    return fine;
}

}  // namespace

LoadTable parse_load_csv(std::string_view text, const std::string& source_name) {
    return factors_of(parse_number_table(text, source_name));
}

LoadTable read_history(const SettingsTable& table, const fs::path& folder) {
    LoadTable history = table.has("file") ? read_file(table, folder) : read_lists(table);
    if (history.time_s.empty()) table.fail("there is no row above time 0; give at least one");
    const auto longest = table.number("longest_step_s", {0, any_number.high, true});
    if (!longest) return history;
    if (history.time_s.back() / *longest > most_rows)
        table.refuse("longest_step_s",
                     fmt::format("allowed: steps of at least {:g} s, which makes {} of them",
                                 history.time_s.back() / most_rows, most_rows));
    return refined(history, *longest);
}

}  // namespace palpate
