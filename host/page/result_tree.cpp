// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/result_tree.hpp"

#include <charconv>
#include <cmath>
#include <type_traits>
#include <utility>

#include "host/page/numbers.hpp"

namespace palpate {
namespace {

std::string number_text(const Figure& figure, double value, const char* dash) {
    if (!std::isfinite(value)) return dash;
    return figure.decimals < 0 ? significant(value) : decimals(value, figure.decimals);
}

/// "(1.00, 2.00, 3.00)".
template <class Values, class Text>
std::string in_brackets(const Values& values, const Text& text) {
    std::string out;
    for (const auto& value : values) out += (out.empty() ? "(" : ", ") + text(value);
    return out.empty() ? "()" : out + ")";
}

/// Part `step` of the tree: by name, of a list also by position from 0.
const ResultTree* part_of(const ResultTree& tree, std::string_view step) {
    std::size_t position = 0;
    const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), position);
    const bool is_position = tree.shape == ResultTree::Shape::list && error == std::errc() &&
                             end == step.data() + step.size();
    const std::vector<const ResultTree*> parts = tree.parts();
    if (is_position) return position < parts.size() ? parts[position] : nullptr;
    for (const ResultTree* part : parts)
        if (part->name == step) return part;
    return nullptr;
}

}  // namespace

ResultTree ResultTree::of(std::string name,
                          std::initializer_list<std::pair<const char*, FigureValue>> figures) {
    ResultTree tree{.name = std::move(name)};
    for (const auto& [key, value] : figures) tree.add(key, value);
    return tree;
}

Figure& ResultTree::add(Figure figure) {
    return std::get<Figure>(children.emplace_back(std::move(figure)));
}

ResultTree& ResultTree::add(ResultTree part) {
    return std::get<ResultTree>(children.emplace_back(std::move(part)));
}

Figure& ResultTree::add(std::string key, FigureValue value) {
    return add(Figure{.name = std::move(key), .value = std::move(value)});
}

ResultTree& ResultTree::add_part(std::string key, Shape of) {
    return add(ResultTree{.name = std::move(key), .shape = of});
}

std::vector<const Figure*> ResultTree::figures() const {
    std::vector<const Figure*> list;
    for (const Child& child : children)
        if (const auto* figure = std::get_if<Figure>(&child)) list.push_back(figure);
    return list;
}

std::vector<const ResultTree*> ResultTree::parts() const {
    std::vector<const ResultTree*> list;
    for (const Child& child : children)
        if (const auto* part = std::get_if<ResultTree>(&child)) list.push_back(part);
    return list;
}

const Figure* find_figure(const ResultTree& tree, std::string_view path) {
    const ResultTree* at = &tree;
    for (std::size_t slash = path.find('/'); slash != path.npos; slash = path.find('/')) {
        at = part_of(*at, path.substr(0, slash));
        if (!at) return nullptr;
        path.remove_prefix(slash + 1);
    }
    for (const Figure* figure : at->figures())
        if (figure->name == path) return figure;
    return nullptr;
}

std::string shown_value(const Figure& figure, const char* dash) {
    if (figure.verdict == Verdict::not_identifiable) return dash;
    const auto number = [&](double value) { return number_text(figure, value, dash); };
    const auto shown = [&](const auto& value) -> std::string {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::monostate>)
            return dash;
        else if constexpr (std::is_same_v<Value, bool>)
            return value ? "yes" : "no";
        else if constexpr (std::is_same_v<Value, std::int64_t>)
            return std::to_string(value);
        else if constexpr (std::is_same_v<Value, double>)
            return number(value);
        else if constexpr (std::is_same_v<Value, std::string>)
            return value;
        else if constexpr (std::is_same_v<Value, std::vector<std::int64_t>>)
            return in_brackets(value, [](std::int64_t one) { return std::to_string(one); });
        else if constexpr (std::is_same_v<Value, std::vector<double>>)
            return in_brackets(value, number);
        else if constexpr (std::is_same_v<Value, std::vector<std::string>>)
            return in_brackets(value, [](const std::string& one) { return one; });
        else
            return in_brackets(
                value, [&](const std::vector<double>& row) { return in_brackets(row, number); });
    };
    return std::visit(shown, figure.value);
}

std::string shown_interval(const Figure& figure, const char* between, const char* dash) {
    if (!figure.interval_95) return dash;
    const auto [low, high] = *figure.interval_95;
    if (low == high || (std::isnan(low) && std::isnan(high))) return dash;
    return number_text(figure, low, "n/a") + between + number_text(figure, high, "n/a");
}

std::string shown_with_unit(const Figure& figure) {
    const bool has_unit = !figure.unit.empty() && figure.verdict != Verdict::not_identifiable;
    return has_unit ? shown_value(figure) + " " + figure.unit : shown_value(figure);
}

std::vector<std::pair<std::string, std::string>> titled_rows(const ResultTree& tree) {
    std::vector<std::pair<std::string, std::string>> rows;
    if (tree.shape == ResultTree::Shape::list) return rows;
    for (const ResultTree::Child& child : tree.children) {
        if (const auto* part = std::get_if<ResultTree>(&child)) {
            for (auto& row : titled_rows(*part)) rows.push_back(std::move(row));
        } else if (const Figure& figure = std::get<Figure>(child);
                   !figure.title.empty() && !figure.is_estimate()) {
            rows.emplace_back(figure.title, shown_with_unit(figure));
        }
    }
    return rows;
}

}  // namespace palpate
