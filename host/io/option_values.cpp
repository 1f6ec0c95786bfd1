// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/option_values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

bool is_off(const SettingValue& value) {
    const auto* flag = std::get_if<bool>(&value);
    return flag && !*flag;
}

std::string as_in_settings(const Option& option) { return option.name; }

std::string as_in_commands(const Option& option) {
    return option.is_positional ? option.name : command_line_name(option.name);
}

std::map<std::string, SettingValue> usual_values(const std::vector<Option>& table) {
    std::map<std::string, SettingValue> values;
    for (const Option& option : table)
        if (option.usual) values.emplace(option.name, *option.usual);
    return values;
}

[[noreturn]] void refuse_words(const Option& option, const std::vector<std::string>& words) {
    const std::string name = as_in_commands(option);
    if (option.kind == OptionKind::choice)
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("{}: {} not in {{{}}}", name, fmt::join(words, " "),
                                fmt::join(option.choices, ",")));
    throw Error(
        ErrorCode::invalid_argument,
        fmt::format("{} is {}; allowed: {}", name, fmt::join(words, " "), allowed_text(option)));
}

bool is_part_of_name(char letter) {
    return std::isalnum(static_cast<unsigned char>(letter)) || letter == '-' || letter == '_';
}

/// Whole names only: not "--out" in "--outline".
void replace_name(std::string& text, const std::string& name, const std::string& by) {
    for (std::size_t at = text.find(name); at != text.npos; at = text.find(name, at)) {
        const std::size_t end = at + name.size();
        const bool is_whole = (at == 0 || !is_part_of_name(text[at - 1])) &&
                              (end == text.size() || !is_part_of_name(text[end]));
        if (is_whole) text.replace(at, name.size(), by);
        at = is_whole ? at + by.size() : end;
    }
}

}  // namespace

std::string as_settings_spell(const std::vector<Option>& table, std::string text) {
    for (const Option& option : table)
        replace_name(text, command_line_name(option.name), option.name);
    return text;
}

std::string as_commands_spell(const std::vector<Option>& table, std::string text) {
    for (const Option& option : table)
        if (!option.is_positional && option.name.find('_') != option.name.npos)
            replace_name(text, option.name, command_line_name(option.name));
    return text;
}

std::string command_line_name(const std::string& name) {
    std::string spelled = "--" + name;
    std::replace(spelled.begin(), spelled.end(), '_', '-');
    return spelled;
}

OptionValues OptionValues::from_settings(const std::vector<Option>& table, const std::string& toml,
                                         const std::string& source_name) {
    const SettingsTable settings = SettingsTable::parse(toml, source_name);
    OptionValues result;
    result.table_ = table;
    result.values_ = usual_values(table);
    std::vector<std::string_view> names;
    for (const Option& option : table) names.push_back(option.name);
    settings.allow_keys(names);
    for (const Option& option : table) {
        const std::optional<SettingValue> value = settings.value(option.name);
        if (!value) continue;
        const std::optional<SettingValue> kept = accepted(option, *value);
        if (!kept) settings.refuse(option.name, "allowed: " + allowed_text(option));
        result.values_[option.name] = *kept;
        if (!is_off(*kept)) result.given_.insert(option.name);
    }
    result.check(as_in_settings);
    return result;
}

OptionValues OptionValues::from_words(const std::vector<Option>& table, const OptionWords& words) {
    OptionValues result;
    result.table_ = table;
    result.values_ = usual_values(table);
    for (const auto& [name, given] : words) {
        const Option& option = result.find(name);
        const std::optional<SettingValue> kept = accepted_words(option, given);
        if (!kept) refuse_words(option, given);
        result.values_[name] = *kept;
        if (!is_off(*kept)) result.given_.insert(name);
    }
    result.check(as_in_commands);
    return result;
}

/// Options that are missing or do not go together.
void OptionValues::check(Spelling spelled) const {
    for (const Option& option : table_) {
        const bool is_set = given_.count(option.name) > 0;
        if (option.is_required && !is_set)
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("{} is required: {}; allowed: {}", spelled(option),
                                    option.meaning, allowed_text(option)));
        if (!is_set) continue;
        for (const std::string& other : option.excluded)
            if (given_.count(other))
                throw Error(ErrorCode::invalid_argument,
                            fmt::format("{} excludes {}; leave one of them out", spelled(option),
                                        spelled(find(other))));
        for (const std::string& other : option.needed)
            if (!given_.count(other))
                throw Error(ErrorCode::invalid_argument,
                            fmt::format("{} requires {}; give it, or leave {} out", spelled(option),
                                        spelled(find(other)), spelled(option)));
    }
}

const Option& OptionValues::find(const std::string& name) const {
    const Option* option = find_option(table_, name);
    if (!option) throw Error(ErrorCode::internal, "there is no option '" + name + "'");
    return *option;
}

template <class Value>
const Value* OptionValues::value(const std::string& name) const {
    const auto found = values_.find(find(name).name);
    if (found == values_.end()) return nullptr;
    if (const auto* held = std::get_if<Value>(&found->second)) return held;
    throw Error(ErrorCode::internal, "option '" + name + "' is of another kind");
}

std::optional<SettingValue> OptionValues::setting(const std::string& name) const {
    const auto found = values_.find(find(name).name);
    return found == values_.end() ? std::nullopt : std::optional(found->second);
}

bool OptionValues::flag(const std::string& name) const {
    const bool* held = value<bool>(name);
    return held && *held;
}

std::int64_t OptionValues::whole(const std::string& name) const {
    const auto* held = value<std::int64_t>(name);
    if (!held) throw Error(ErrorCode::internal, "option '" + name + "' has no value");
    return *held;
}

double OptionValues::number(const std::string& name) const {
    const auto held = optional_number(name);
    if (!held) throw Error(ErrorCode::internal, "option '" + name + "' has no value");
    return *held;
}

std::optional<double> OptionValues::optional_number(const std::string& name) const {
    const double* held = value<double>(name);
    return held ? std::optional(*held) : std::nullopt;
}

std::string OptionValues::text(const std::string& name) const {
    const auto* held = value<std::string>(name);
    return held ? *held : "";
}

std::vector<double> OptionValues::numbers(const std::string& name) const {
    const auto* held = value<std::vector<double>>(name);
    return held ? *held : std::vector<double>{};
}

std::vector<std::string> OptionValues::texts(const std::string& name) const {
    const auto* held = value<std::vector<std::string>>(name);
    return held ? *held : std::vector<std::string>{};
}

}  // namespace palpate
