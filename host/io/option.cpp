// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/option.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

Option named(std::string name, OptionKind kind, std::string meaning) {
    Option option;
    option.name = std::move(name);
    option.kind = kind;
    option.meaning = std::move(meaning);
    return option;
}

std::optional<double> number_of(const SettingValue& value) {
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
    if (const auto* number = std::get_if<double>(&value)) return *number;
    return std::nullopt;
}

bool is_within(const Option& option, double value) {
    const NumberRange& range = option.range;
    return std::isfinite(value) && value <= range.high &&
           (range.open_low ? value > range.low : value >= range.low);
}

bool is_allowed_text(const Option& option, const std::string& text) {
    const auto& choices = option.choices;
    return option.kind != OptionKind::choice ||
           std::find(choices.begin(), choices.end(), text) != choices.end();
}

/// One value of an option that takes one.
std::optional<SettingValue> accepted_one(const Option& option, const SettingValue& value) {
    if (option.kind == OptionKind::flag)
        return std::holds_alternative<bool>(value) ? std::optional(value) : std::nullopt;
    if (option.is_number()) {
        const std::optional<double> number = number_of(value);
        if (!number || !is_within(option, *number)) return std::nullopt;
        if (option.kind == OptionKind::number) return *number;
        return std::holds_alternative<std::int64_t>(value) ? std::optional(value) : std::nullopt;
    }
    const auto* text = std::get_if<std::string>(&value);
    return text && is_allowed_text(option, *text) ? std::optional(value) : std::nullopt;
}

bool is_count(const Option& option, std::size_t count) {
    return count >= option.least && count <= option.most;
}

std::optional<SettingValue> accepted_numbers(const Option& option,
                                             const std::vector<double>& values) {
    const bool is_whole = std::all_of(values.begin(), values.end(),
                                      [](double one) { return one == std::floor(one); });
    const bool are_within = std::all_of(values.begin(), values.end(),
                                        [&](double one) { return is_within(option, one); });
    if (!is_count(option, values.size()) || !are_within) return std::nullopt;
    if (option.kind == OptionKind::integer && !is_whole) return std::nullopt;
    return values;
}

std::optional<SettingValue> accepted_texts(const Option& option,
                                           const std::vector<std::string>& values) {
    const bool are_allowed = std::all_of(values.begin(), values.end(), [&](const auto& one) {
        return is_allowed_text(option, one);
    });
    return is_count(option, values.size()) && are_allowed ? std::optional<SettingValue>(values)
                                                          : std::nullopt;
}

/// The whole word as a number.
template <class Number>
std::optional<Number> parsed(const std::string& word) {
    Number number{};
    const char* end = word.data() + word.size();
    const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
    const auto [stopped, error] = std::from_chars(begin, end, number);
    return error == std::errc() && stopped == end ? std::optional(number) : std::nullopt;
}

std::optional<SettingValue> number_in(const Option& option, const std::string& word) {
    if (option.kind == OptionKind::integer) {
        if (const auto whole = parsed<std::int64_t>(word)) return *whole;
    } else if (const auto number = parsed<double>(word)) {
        return *number;
    }
    return std::nullopt;
}

std::string range_text(const Option& option) {
    const NumberRange& range = option.range;
    std::string text = option.kind == OptionKind::integer ? "a whole number" : "a number";
    if (option.is_list()) text = option.kind == OptionKind::integer ? "whole numbers" : "numbers";
    if (range.low > any_number.low)
        text += fmt::format(" {} {}", range.open_low ? "greater than" : "of at least", range.low);
    if (range.high < any_number.high)
        text +=
            fmt::format(" {}at most {}", range.low > any_number.low ? "and " : "of ", range.high);
    return text;
}

std::string one_text(const Option& option) {
    const bool list = option.is_list();
    switch (option.kind) {
        case OptionKind::flag:
            return "true or false";
        case OptionKind::integer:
        case OptionKind::number:
            return range_text(option);
        case OptionKind::text:
            return list ? "texts" : "text";
        case OptionKind::choice:
            return fmt::format("one of {}", fmt::join(option.choices, ", "));
        case OptionKind::input_file:
        case OptionKind::output_file:
            return list ? "paths of files" : "path of a file";
        case OptionKind::folder:
            return "path of a folder";
    }
    return "";
}

/// As TOML.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            out += {'\\', c};
        else if (code < 0x20 || code == 0x7f)
            out += fmt::format("\\u{:04x}", code);
        else
            out += c;
    }
    return out + '"';
}

}  // namespace

const char* name_of(OptionKind kind) {
    constexpr const char* names[] = {"flag",   "integer",    "number",      "text",
                                     "choice", "input file", "output file", "folder"};
    return names[static_cast<std::size_t>(kind)];
}

Option Option::flag(std::string name, std::string meaning) {
    return named(std::move(name), OptionKind::flag, std::move(meaning)).usually(false);
}

Option Option::integer(std::string name, double low, double high, std::string meaning) {
    Option option = named(std::move(name), OptionKind::integer, std::move(meaning));
    option.range = {low, high};
    return option;
}

Option Option::number(std::string name, std::string unit, NumberRange range, std::string meaning) {
    Option option = named(std::move(name), OptionKind::number, std::move(meaning));
    option.unit = std::move(unit);
    option.range = range;
    return option;
}

Option Option::text(std::string name, std::string meaning) {
    return named(std::move(name), OptionKind::text, std::move(meaning));
}

Option Option::choice(std::string name, std::vector<std::string> choices, std::string meaning) {
    Option option = named(std::move(name), OptionKind::choice, std::move(meaning));
    option.choices = std::move(choices);
    return option;
}

Option Option::input_file(std::string name, std::string meaning) {
    return named(std::move(name), OptionKind::input_file, std::move(meaning));
}

Option Option::output_file(std::string name, std::string meaning) {
    return named(std::move(name), OptionKind::output_file, std::move(meaning));
}

Option Option::folder(std::string name, std::string meaning) {
    return named(std::move(name), OptionKind::folder, std::move(meaning));
}

Option Option::required() const {
    Option option = *this;
    option.is_required = true;
    return option;
}

Option Option::positional() const {
    Option option = *this;
    option.is_positional = true;
    return option;
}

Option Option::usually(const SettingValue& value) const {
    Option option = *this;
    option.usual = accepted(*this, value);
    if (!option.usual)
        throw Error(ErrorCode::internal, fmt::format("{} is usually {}; allowed: {}", name,
                                                     setting_text(value), allowed_text(*this)));
    return option;
}

Option Option::list(std::size_t low, std::size_t high) const {
    Option option = *this;
    option.least = low;
    option.most = high;
    return option;
}

Option Option::excludes(std::vector<std::string> names) const {
    Option option = *this;
    option.excluded = std::move(names);
    return option;
}

Option Option::needs(std::vector<std::string> names) const {
    Option option = *this;
    option.needed = std::move(names);
    return option;
}

const Option* find_option(const std::vector<Option>& table, const std::string& name) {
    const auto found = std::find_if(table.begin(), table.end(),
                                    [&](const Option& option) { return option.name == name; });
    return found == table.end() ? nullptr : &*found;
}

std::string allowed_text(const Option& option) {
    std::string text = one_text(option);
    if (!option.unit.empty()) text += fmt::format(" ({})", option.unit);
    if (!option.is_list()) return text;
    if (option.least == option.most) return fmt::format("{} {}", option.least, text);
    if (option.most >= Option::any_count) return fmt::format("{} or more {}", option.least, text);
    return fmt::format("{} to {} {}", option.least, option.most, text);
}

std::string setting_text(const SettingValue& value) {
    if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
    if (const auto number = number_of(value)) return fmt::format("{}", *number);
    if (const auto* text = std::get_if<std::string>(&value)) return quoted(*text);
    if (const auto* numbers = std::get_if<std::vector<double>>(&value))
        return fmt::format("[{}]", fmt::join(*numbers, ", "));
    std::vector<std::string> texts;
    for (const std::string& text : std::get<std::vector<std::string>>(value))
        texts.push_back(quoted(text));
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::optional<SettingValue> accepted(const Option& option, const SettingValue& value) {
    if (!option.is_list()) return accepted_one(option, value);
    if (option.is_number()) {
        if (const auto one = number_of(value)) return accepted_numbers(option, {*one});
        const auto* list = std::get_if<std::vector<double>>(&value);
        return list ? accepted_numbers(option, *list) : std::nullopt;
    }
    if (const auto* one = std::get_if<std::string>(&value)) return accepted_texts(option, {*one});
    const auto* list = std::get_if<std::vector<std::string>>(&value);
    return list ? accepted_texts(option, *list) : std::nullopt;
}

std::optional<SettingValue> accepted_words(const Option& option,
                                           const std::vector<std::string>& words) {
    if (option.kind == OptionKind::flag) return true;
    if (!option.is_number())
        return option.is_list() ? accepted(option, words)
               : words.empty()  ? std::nullopt
                                : accepted(option, words.front());
    std::vector<double> numbers;
    std::optional<SettingValue> last;
    for (const std::string& word : words) {
        last = number_in(option, word);
        if (!last) return std::nullopt;
        numbers.push_back(*number_of(*last));
    }
    if (option.is_list()) return accepted(option, numbers);
    return last ? accepted(option, *last) : std::nullopt;
}

}  // namespace palpate
