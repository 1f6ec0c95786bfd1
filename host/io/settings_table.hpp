// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace palpate {

/// Allowed numbers of one key; `open_low` excludes the lower end.
struct NumberRange {
    double low, high;
    bool open_low = false;
    /// Whether `value` is finite and within.
    bool contains(double value) const {
        return value <= high && (open_low ? value > low : value >= low) &&
               value >= std::numeric_limits<double>::lowest() &&
               value <= std::numeric_limits<double>::max();
    }
};
/// Every number but infinite ones and NaN.
inline constexpr NumberRange any_number{-std::numeric_limits<double>::max(),
                                        std::numeric_limits<double>::max()};

/// What a key can hold. A list of whole numbers is one of numbers.
using SettingValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                                  std::vector<std::string>>;

/// A number of a document that is not just given: "unknown", {unknown = true, ...}, or
/// {value = ..., sd = ...}, known with an error.
struct OpenNumber {
    /// Where it stands: "material[1].mu_kpa", lists counted from 1; "gap.size_mm[2]" in a list.
    std::string path;
    std::string key;                 ///< "mu_kpa"
    NumberRange range = any_number;  ///< that its key allows
    bool is_unknown = true;          ///< else `value` and `sd` are given
    double value = 0;
    std::optional<double> sd = {};     ///< of the value itself
    std::optional<double> sd_ln = {};  ///< of its logarithm
    std::optional<double> start = {};  ///< where a search begins
    std::optional<double> lowest = {}, highest = {};
    std::optional<double> median = {};  ///< of the prior
    bool is_held = false;               ///< data do not change the value
};

/// Gives the number that stands for an open one. Throws Error(invalid_argument) if there is none.
using OpenNumbers = std::function<double(const OpenNumber&)>;

/// One table of a TOML document, read strictly: every complaint is an Error(invalid_argument) of
/// the form "file, line n: [table]: key 'k' is v; allowed: ...". Keeps the toml library out of
/// headers.
class SettingsTable {
public:
    /// Parses a document. Throws Error(input_unreadable) with the line if it is not TOML.
    /// `open_numbers` answers for numbers that are open; without it they are refused.
    static SettingsTable parse(const std::string& toml, const std::string& source_name,
                               OpenNumbers open_numbers = {});

    /// Throws for the first key that is not in `keys`.
    void allow_keys(const std::vector<std::string_view>& keys) const;
    bool has(std::string_view key) const;
    std::vector<std::string> keys() const;

    std::optional<SettingsTable> table(std::string_view key) const;
    std::vector<SettingsTable> tables(std::string_view key) const;  ///< [[key]]; empty if absent

    /// `allowed` says what is, in a complaint; empty: the range.
    std::optional<double> number(std::string_view key, NumberRange range,
                                 const std::string& allowed = {}) const;
    /// A list of at least `least` and at most `most` numbers.
    std::optional<std::vector<double>> numbers(std::string_view key, std::size_t least,
                                               std::size_t most) const;
    std::optional<int> whole_number(std::string_view key, int low, int high) const;
    std::optional<bool> yes_or_no(std::string_view key) const;
    std::optional<std::string> text(std::string_view key) const;
    /// Whatever the key holds, for those who judge it themselves; empty if the key is absent.
    /// Refuses tables, times and lists of mixed things. An empty list is one of texts.
    std::optional<SettingValue> value(std::string_view key) const;
    /// Text that must be one of `choices`.
    std::optional<std::string> choice(std::string_view key,
                                      std::initializer_list<std::string_view> choices) const;
    /// Whether the value is exactly this text.
    bool is_text(std::string_view key, std::string_view value) const;

    /// Throws that a needed key is missing.
    [[noreturn]] void missing(std::string_view key, const std::string& allowed) const;
    /// Throws that the value of `key` is not allowed.
    [[noreturn]] void refuse(std::string_view key, const std::string& allowed) const;
    /// Throws a complaint about the table as a whole.
    [[noreturn]] void fail(const std::string& complaint) const;

    /// Adds the name of the thing the table describes to later complaints.
    void set_subject(const std::string& subject);

private:
    struct Node;
    struct Place;
    class OpenNumberReader;
    /// What stands for an open number there; empty if there is none.
    std::optional<double> open_number(std::string_view key, const Place& place,
                                      NumberRange range) const;
    std::shared_ptr<const Node> node_;  ///< the table and the document that owns it
    std::string source_, title_, path_;
    std::shared_ptr<const OpenNumbers> open_numbers_;
};

}  // namespace palpate
