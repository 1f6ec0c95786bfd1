// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/settings_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include <toml++/toml.h>

#include "solver/base/error.hpp"

namespace palpate {

struct SettingsTable::Node {
    std::shared_ptr<const toml::table> document;
    const toml::table* table = nullptr;
};

namespace {

constexpr std::size_t longest_shown_value = 60;
constexpr std::size_t most_dots_in_a_key = 32;

std::string shown(const toml::node& value) {
    std::ostringstream out;
    value.visit([&](const auto& v) {
        if constexpr (toml::is_table<decltype(v)>)
            out << "a table";
        else if constexpr (toml::is_array<decltype(v)>)
            out << "a list";
        else if constexpr (toml::is_floating_point<decltype(v)>)
            out << fmt::format("{}", *v);  // the shortest digits that mean the number
        else
            out << toml::node_view<const toml::node>(v);
    });
    std::string text = out.str();
    std::replace(text.begin(), text.end(), '\n', ' ');
    if (text.size() > longest_shown_value) text = text.substr(0, longest_shown_value) + "...";
    return text;
}

std::string shown(NumberRange range) {
    if (range.low == any_number.low && range.high == any_number.high) return "a number";
    if (range.high == any_number.high)
        return fmt::format("a number {} {:g}", range.open_low ? "greater than" : "of at least",
                           range.low);
    return fmt::format("a number {} {:g} and at most {:g}",
                       range.open_low ? "greater than" : "of at least", range.low, range.high);
}

/// Letter changes needed to turn one word into the other, to guess what a wrong key should be.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
        }
    }
    return row[b.size()];
}

/// Where a string or comment that begins at `at` ends; `at` itself if none begins there.
std::size_t end_of_opaque(std::string_view text, std::size_t at) {
    const auto after = [&](std::size_t found, std::size_t length) {
        return found == std::string_view::npos ? text.size() : found + length;
    };
    const char c = text[at];
    if (c == '#') return after(text.find('\n', at), 0);
    if (c != '"' && c != '\'') return at;
    const bool is_long = at + 2 < text.size() && text[at + 1] == c && text[at + 2] == c;
    for (std::size_t k = at + (is_long ? 3 : 1); k < text.size(); ++k) {
        if (c == '"' && text[k] == '\\') {
            ++k;
        } else if (!is_long && (text[k] == c || text[k] == '\n')) {
            return k + 1;
        } else if (is_long && text.substr(k, 3) == text.substr(at, 3)) {
            k += 3;
            for (int more = 0; more < 2 && k < text.size() && text[k] == c; ++more) ++k;
            return k;
        }
    }
    return text.size();
}

/// The most dots in one key. The parser makes a table inside a table for each, without limit, and
/// taking them down again then overflows the stack.
std::size_t deepest_key(std::string_view text) {
    std::size_t dots = 0, most = 0;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = end_of_opaque(text, at);
        if (end > at) {
            at = end;
            continue;
        }
        const char c = text[at++];
        if (c == '.') most = std::max(most, ++dots);
        if (std::string_view("=,{}[]\n").find(c) != std::string_view::npos) dots = 0;
    }
    return most;
}

}  // namespace

struct SettingsTable::Place {
    const toml::node& node;
    std::string path;
};

/// Reads what stands in a number's place.
class SettingsTable::OpenNumberReader {
public:
    OpenNumberReader(const SettingsTable& table, std::string_view key, const toml::node& node)
        : table_(table), key_(key), node_(node) {}

    bool is_open() const { return node_.is_table() || is_word("unknown"); }

    OpenNumber read(std::string path, NumberRange range) const {
        OpenNumber open{.path = std::move(path), .key = std::string(key_), .range = range};
        if (const toml::table* inner = node_.as_table()) {
            for (const auto& [name, value] : *inner) take(name.str(), value, open);
            check(*inner, open);
        }
        return open;
    }

private:
    bool is_word(std::string_view word) const {
        return node_.is_string() && node_.value<std::string_view>() == word;
    }

    void take(std::string_view name, const toml::node& value, OpenNumber& open) const {
        if (name == "unknown") {
            if (!value.is_boolean() || !*value.value<bool>())
                refuse("unknown is true, or left out");
            return;
        }
        if (name == "held") {
            if (!value.is_boolean()) refuse("held is true or false");
            open.is_held = *value.value<bool>();
            return;
        }
        const auto number = value.is_number() ? value.value<double>() : std::nullopt;
        if (!number || !std::isfinite(*number)) refuse(fmt::format("{} is a number", name));
        if (name == "value")
            open.value = *number;
        else if (std::optional<double>* place = place_of(name, open))
            *place = *number;
        else
            refuse(fmt::format("'{}' is not known there", name));
    }

    static std::optional<double>* place_of(std::string_view name, OpenNumber& open) {
        if (name == "sd") return &open.sd;
        if (name == "sd_ln") return &open.sd_ln;
        if (name == "start") return &open.start;
        if (name == "lowest") return &open.lowest;
        if (name == "highest") return &open.highest;
        return name == "median" ? &open.median : nullptr;
    }

    void check(const toml::table& inner, OpenNumber& open) const {
        open.is_unknown = inner.contains("unknown");
        const bool has_value = inner.contains("value");
        if (open.is_unknown == has_value) refuse("it is either unknown or has a value");
        if (has_value && (open.start || open.lowest || open.highest || open.median))
            refuse("beside a value stands its sd alone");
        if (!has_value && open.is_held) refuse("what is held has a value and its sd");
        if (has_value && open.sd.has_value() == open.sd_ln.has_value())
            refuse("beside a value stands its sd, or the sd_ln of its logarithm");
        if ((open.sd && !(*open.sd > 0)) || (open.sd_ln && !(*open.sd_ln > 0)))
            refuse("a standard deviation is greater than 0");
        if (open.lowest && open.highest && !(*open.lowest < *open.highest))
            refuse("lowest is less than highest");
        for (const auto& number : {has_value ? std::optional(open.value) : std::nullopt, open.start,
                                   open.lowest, open.highest, open.median})
            if (number && !open.range.contains(*number)) refuse("allowed: " + shown(open.range));
    }

    [[noreturn]] void refuse(const std::string& why) const {
        table_.refuse(key_, fmt::format("{}; allowed: \"unknown\", {{unknown = true, start = ..., "
                                        "lowest = ..., highest = ..., median = ..., sd_ln = ...}}, "
                                        "or {{value = ..., sd = ..., held = true}}",
                                        why));
    }

    const SettingsTable& table_;
    std::string_view key_;
    const toml::node& node_;
};

SettingsTable SettingsTable::parse(const std::string& toml, const std::string& source_name,
                                   OpenNumbers open_numbers) {
    if (deepest_key(toml) > most_dots_in_a_key)
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{}: a key has more than {} parts; no setting needs more than two",
                                source_name, most_dots_in_a_key));
    try {
        auto document = std::make_shared<const toml::table>(toml::parse(toml));
        SettingsTable result;
        result.node_ = std::make_shared<const Node>(Node{document, document.get()});
        result.source_ = source_name;
        if (open_numbers)
            result.open_numbers_ = std::make_shared<const OpenNumbers>(std::move(open_numbers));
        return result;
    } catch (const toml::parse_error& e) {
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("{}, line {}: not valid TOML: {}; correct that line", source_name,
                                e.source().begin.line, e.description()));
    }
}

void SettingsTable::allow_keys(const std::vector<std::string_view>& keys) const {
    for (const auto& [key, value] : *node_->table) {
        if (std::find(keys.begin(), keys.end(), key.str()) != keys.end()) continue;
        std::string guess;
        std::size_t nearest = 3;  // letters: farther away it is another word
        for (std::string_view known : keys) {
            const std::size_t distance = edit_distance(key.str(), known);
            if (distance >= nearest) continue;
            nearest = distance;
            guess = fmt::format(" (did you mean '{}'?)", known);
        }
        refuse(key.str(),
               fmt::format("not known here{}; known keys: {}", guess, fmt::join(keys, ", ")));
    }
}

bool SettingsTable::has(std::string_view key) const { return node_->table->contains(key); }

std::vector<std::string> SettingsTable::keys() const {
    std::vector<std::string> names;
    for (const auto& [key, value] : *node_->table) names.emplace_back(key.str());
    return names;
}

std::optional<SettingsTable> SettingsTable::table(std::string_view key) const {
    if (!has(key)) return std::nullopt;
    const toml::table* inner = node_->table->get(key)->as_table();
    if (!inner) refuse(key, fmt::format("allowed: one table, written [{}]", key));
    SettingsTable result = *this;
    result.node_ = std::make_shared<const Node>(Node{node_->document, inner});
    result.title_ += fmt::format("{}[{}]", title_.empty() ? "" : " ", key);
    result.path_ += fmt::format("{}.", key);
    return result;
}

std::vector<SettingsTable> SettingsTable::tables(std::string_view key) const {
    std::vector<SettingsTable> result;
    if (!has(key)) return result;
    const std::string allowed = fmt::format("allowed: tables, written [[{}]]", key);
    const toml::array* list = node_->table->get(key)->as_array();
    if (!list) refuse(key, allowed);
    for (const toml::node& item : *list) {
        if (!item.is_table()) refuse(key, allowed);
        SettingsTable inner = *this;
        inner.node_ = std::make_shared<const Node>(Node{node_->document, item.as_table()});
        inner.title_ +=
            fmt::format("{}[[{}]] number {}", title_.empty() ? "" : " ", key, result.size() + 1);
        inner.path_ += fmt::format("{}[{}].", key, result.size() + 1);
        result.push_back(inner);
    }
    return result;
}

std::optional<double> SettingsTable::number(std::string_view key, NumberRange range,
                                            const std::string& allowed) const {
    if (!has(key)) return std::nullopt;
    const toml::node* node = node_->table->get(key);
    if (const auto open = open_number(key, {*node, path_ + std::string(key)}, range)) return open;
    const std::optional<double> value =
        node->is_number() ? node->value<double>() : std::optional<double>{};
    if (!value || !range.contains(*value))
        refuse(key, "allowed: " + (allowed.empty() ? shown(range) : allowed));
    return value;
}

std::optional<double> SettingsTable::open_number(std::string_view key, const Place& place,
                                                 NumberRange range) const {
    const OpenNumberReader reader(*this, key, place.node);
    if (!open_numbers_ || !reader.is_open()) return std::nullopt;
    return (*open_numbers_)(reader.read(place.path, range));
}

std::optional<std::vector<double>> SettingsTable::numbers(std::string_view key, std::size_t least,
                                                          std::size_t most) const {
    if (!has(key)) return std::nullopt;
    const auto wrong = [&] {
        const std::string count = least == most ? fmt::format("{}", least)
                                  : most > 1000 ? fmt::format("at least {}", least)
                                                : fmt::format("{} to {}", least, most);
        refuse(key, fmt::format("allowed: a list of {} numbers in square brackets", count));
    };
    const toml::array* list = node_->table->get(key)->as_array();
    if (!list || list->size() < least || list->size() > most) wrong();
    std::vector<double> values;
    for (const toml::node& item : *list) {
        auto value = open_number(
            key, {item, fmt::format("{}{}[{}]", path_, key, values.size() + 1)}, any_number);
        if (!value && item.is_number()) value = item.value<double>();
        if (!value || !std::isfinite(*value)) wrong();
        values.push_back(*value);
    }
    return values;
}

std::optional<int> SettingsTable::whole_number(std::string_view key, int low, int high) const {
    if (!has(key)) return std::nullopt;
    const toml::node* node = node_->table->get(key);
    const std::optional<std::int64_t> value =
        node->is_integer() ? node->value<std::int64_t>() : std::optional<std::int64_t>{};
    if (!value || *value < low || *value > high)
        refuse(key, fmt::format("allowed: a whole number from {} to {}", low, high));
    return static_cast<int>(*value);
}

std::optional<bool> SettingsTable::yes_or_no(std::string_view key) const {
    if (!has(key)) return std::nullopt;
    const toml::node* node = node_->table->get(key);
    if (!node->is_boolean()) refuse(key, "allowed: true or false, without quotes");
    return node->value<bool>();
}

std::optional<std::string> SettingsTable::text(std::string_view key) const {
    if (!has(key)) return std::nullopt;
    const toml::node* node = node_->table->get(key);
    if (!node->is_string()) refuse(key, "allowed: text in quotes");
    return node->value<std::string>();
}

std::optional<SettingValue> SettingsTable::value(std::string_view key) const {
    if (!has(key)) return std::nullopt;
    const toml::node& node = *node_->table->get(key);
    if (node.is_boolean()) return node.value<bool>();
    if (node.is_integer()) return node.value<std::int64_t>();
    if (node.is_floating_point()) return node.value<double>();
    if (node.is_string()) return node.value<std::string>();
    const toml::array* list = node.as_array();
    std::vector<double> numbers;
    std::vector<std::string> texts;
    for (std::size_t k = 0; list && k < list->size(); ++k) {
        const toml::node& item = *list->get(k);
        if (item.is_number()) numbers.push_back(*item.value<double>());
        if (item.is_string()) texts.push_back(*item.value<std::string>());
    }
    if (list && texts.size() == list->size()) return texts;
    if (list && numbers.size() == list->size()) return numbers;
    refuse(key, "allowed: a number, text in quotes, true, false, or a list of numbers or of texts");
}

std::optional<std::string> SettingsTable::choice(
    std::string_view key, std::initializer_list<std::string_view> choices) const {
    if (!has(key)) return std::nullopt;
    for (std::string_view c : choices)
        if (is_text(key, c)) return std::string(c);
    refuse(key, fmt::format("allowed: \"{}\"", fmt::join(choices, "\", \"")));
}

bool SettingsTable::is_text(std::string_view key, std::string_view value) const {
    const toml::node* node = node_->table->get(key);
    return node && node->is_string() && node->value<std::string_view>() == value;
}

void SettingsTable::missing(std::string_view key, const std::string& allowed) const {
    fail(fmt::format("key '{}' is missing; allowed: {}", key, allowed));
}

void SettingsTable::refuse(std::string_view key, const std::string& allowed) const {
    const toml::node* node = node_->table->get(key);
    if (!node) fail(fmt::format("key '{}' is left out; {}", key, allowed));
    const std::string place = title_.empty() ? "" : title_ + ": ";
    throw Error(ErrorCode::invalid_argument,
                fmt::format("{}, line {}: {}key '{}' is {}; {}", source_, node->source().begin.line,
                            place, key, shown(*node), allowed));
}

void SettingsTable::fail(const std::string& complaint) const {
    const auto line = node_->table->source().begin.line;
    const std::string where = title_.empty() ? source_ : fmt::format("{}, line {}", source_, line);
    const std::string place = title_.empty() ? "" : title_ + ": ";
    throw Error(ErrorCode::invalid_argument, fmt::format("{}: {}{}", where, place, complaint));
}

void SettingsTable::set_subject(const std::string& subject) {
    title_ += fmt::format(" \"{}\"", subject);
}

}  // namespace palpate
