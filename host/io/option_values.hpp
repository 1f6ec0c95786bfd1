// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/io/option.hpp"

namespace palpate {

/// The words that a command line gave to each option, by its name in the table.
using OptionWords = std::map<std::string, std::vector<std::string>>;

/// Values of the options of a table: those that were given and, of the others, those they usually
/// have. Every given value is allowed by the table. Asking for a name that is not in the table, or
/// for another kind, is an Error(internal).
class OptionValues {
public:
    /// From a settings text in TOML, a key for each option. Throws Error(input_unreadable) if it is
    /// not TOML, Error(invalid_argument) for unknown keys, values that are not allowed, options
    /// that are missing and options that do not go together.
    static OptionValues from_settings(const std::vector<Option>& table, const std::string& toml,
                                      const std::string& source_name);
    /// From the words of a command line, with the same errors.
    static OptionValues from_words(const std::vector<Option>& table, const OptionWords& words);

    /// Whether someone gave it; a flag that is false is as good as not given.
    bool is_given(const std::string& name) const { return given_.count(find(name).name) > 0; }

    /// Whatever it is; empty if it was not given and usually is nothing.
    std::optional<SettingValue> setting(const std::string& name) const;
    bool flag(const std::string& name) const;
    int integer(const std::string& name) const { return static_cast<int>(whole(name)); }
    std::int64_t whole(const std::string& name) const;  ///< an integer that may be large
    double number(const std::string& name) const;
    /// Empty if it was not given and usually is nothing.
    std::optional<double> optional_number(const std::string& name) const;
    /// Of texts, choices and paths; "" if it was not given and usually is nothing.
    std::string text(const std::string& name) const;
    std::filesystem::path path(const std::string& name) const { return text(name); }
    std::vector<double> numbers(const std::string& name) const;
    std::vector<std::string> texts(const std::string& name) const;

private:
    /// How an option is called where the values come from.
    using Spelling = std::string (*)(const Option&);
    const Option& find(const std::string& name) const;
    template <class Value>
    const Value* value(const std::string& name) const;
    void check(Spelling spelled) const;

    std::vector<Option> table_;
    std::map<std::string, SettingValue> values_;
    std::set<std::string> given_;
};

/// "--time-limit" of "time_limit".
std::string command_line_name(const std::string& name);

/// A text about options as someone reads it who writes settings: "time_limit" for "--time-limit".
std::string as_settings_spell(const std::vector<Option>& table, std::string text);
/// The same for someone at a command line. Names of one word, like "nodes", stay as they are: they
/// may be words.
std::string as_commands_spell(const std::vector<Option>& table, std::string text);

}  // namespace palpate
