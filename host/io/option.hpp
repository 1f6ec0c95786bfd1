// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/io/settings_table.hpp"

namespace palpate {

/// What a value of an option is.
enum class OptionKind : std::uint8_t {
    flag,     ///< true or false
    integer,  ///< a whole number
    number,
    text,
    choice,       ///< one of some words
    input_file,   ///< path of a file that is read
    output_file,  ///< path of a file that is made
    folder,       ///< path of a folder that is made
};
/// "flag", "integer", "number", "text", "choice", "input file", "output file", "folder".
const char* name_of(OptionKind kind);

/// One entry of a table of options, from which follow the command line, settings files, C, Python,
/// descriptors for other programs and the pages of the documentation.
/// Made by one of the functions and completed by those that return the option itself:
///     Option::number("force_mn", "mN", {0, 1e6, true}, "Force that pulls at the end").required()
struct Option {
    static constexpr std::size_t any_count = 100000;  ///< of values in a list

    std::string name;  ///< "time_limit": this in files, C and Python; --time-limit in commands
    OptionKind kind = OptionKind::text;
    std::string unit;                   ///< "mm"; empty: none
    std::string meaning;                ///< one sentence, without kind, unit, range and default
    std::optional<SettingValue> usual;  ///< what it is if nobody says; empty: nothing
    NumberRange range = any_number;     ///< of integers and numbers
    std::vector<std::string> choices;   ///< of a choice
    std::size_t least = 1, most = 1;    ///< how many values; more than one: a list
    bool is_required = false;
    bool is_positional = false;         ///< on the command line it needs no name
    std::vector<std::string> excluded;  ///< options that do not go together with this one
    std::vector<std::string> needed;    ///< options without which this one has no meaning

    static Option flag(std::string name, std::string meaning);
    static Option integer(std::string name, double low, double high, std::string meaning);
    static Option number(std::string name, std::string unit, NumberRange range,
                         std::string meaning);
    static Option text(std::string name, std::string meaning);
    static Option choice(std::string name, std::vector<std::string> choices, std::string meaning);
    static Option input_file(std::string name, std::string meaning);
    static Option output_file(std::string name, std::string meaning);
    static Option folder(std::string name, std::string meaning);

    Option required() const;
    Option positional() const;
    Option usually(const SettingValue& value) const;
    /// Between `low` and `high` values, `any_count` for no limit.
    Option list(std::size_t low, std::size_t high) const;
    Option excludes(std::vector<std::string> names) const;
    Option needs(std::vector<std::string> names) const;

    bool is_list() const { return most > 1; }
    /// Whether its name stands before every value on the command line: words that follow belong to
    /// something else.
    bool is_repeated() const { return least < most && !is_positional && !is_number(); }
    bool is_number() const { return kind == OptionKind::integer || kind == OptionKind::number; }
    /// Whether it names a file or folder that is made.
    bool makes_path() const { return kind > OptionKind::input_file; }
};

/// The option of this name; null if there is none.
const Option* find_option(const std::vector<Option>& table, const std::string& name);

/// What a value may be: "a number greater than 0 and at most 100 (mm)", "one of auto, fixed".
std::string allowed_text(const Option& option);
/// A value as people read it and as settings files hold it: 120, "auto", [1.5, 2].
std::string setting_text(const SettingValue& value);

/// The value as the option keeps it (a whole number as a number, one value as a list of one); empty
/// if it is not allowed.
std::optional<SettingValue> accepted(const Option& option, const SettingValue& value);
/// The same for the words of a command line. A flag has none.
std::optional<SettingValue> accepted_words(const Option& option,
                                           const std::vector<std::string>& words);

}  // namespace palpate
