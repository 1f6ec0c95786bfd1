// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "host/estimate/verdict.hpp"

namespace palpate {

/// A value as files hold it; `std::monostate`, and every number that is not finite, is null there.
using FigureValue =
    std::variant<std::monostate, bool, std::int64_t, double, std::string, std::vector<std::int64_t>,
                 std::vector<double>, std::vector<std::string>, std::vector<std::vector<double>>>;

/// One figure of a result. Whoever adds one to the tree has it in JSON, C and Python; with a
/// `title` in tables and pages, too.
struct Figure {
    std::string name = {};     ///< key in files: "stiffness_kpa"; empty: for people only
    FigureValue value = {};    ///< in `unit`
    std::string unit = {};     ///< "kPa"; empty: none
    std::string title = {};    ///< for people: "Young's modulus"; empty: files only
    std::string meaning = {};  ///< one sentence, shown where there is room
    std::optional<std::array<double, 2>> interval_95 = std::nullopt;  ///< 95 %, in `unit`
    std::optional<Verdict> verdict = std::nullopt;
    std::string reason = {};  ///< of the verdict, in words
    int decimals = -1;        ///< shown after the point; negative: three significant digits
    /// In files an estimate (a figure with interval or verdict) is an object of value, unit,
    /// interval, verdict and reason. With a name here, its interval has this key and the verdict
    /// and reason have theirs, all beside the value.
    std::string interval_name = {};

    bool is_estimate() const { return interval_95 || verdict; }
};

/// The figures of a result in order, with parts that have figures of their own. What files, pages,
/// tables, C and Python tell of a result is walked from it.
struct ResultTree {
    enum class Shape : std::uint8_t {
        object,  ///< each child has a key of its own
        list,    ///< of parts alike: an array in files, a table for people
    };
    using Child = std::variant<Figure, ResultTree>;

    std::string name = {};   ///< key in files; of a list's part only for `find_figure`
    std::string title = {};  ///< heading for people; empty: files only
    Shape shape = Shape::object;
    std::vector<Child> children = {};

    /// A part of figures that need no more than a key and a value.
    static ResultTree of(std::string name,
                         std::initializer_list<std::pair<const char*, FigureValue>> figures);

    Figure& add(Figure figure);
    ResultTree& add(ResultTree part);
    /// Most figures: a key and a value for files.
    Figure& add(std::string key, FigureValue value);
    /// An empty part to be filled.
    ResultTree& add_part(std::string key, Shape of = Shape::object);

    std::vector<const Figure*> figures() const;
    std::vector<const ResultTree*> parts() const;
};

/// The figure at "regions/prostate/stiffness_kpa": names, or positions from 0 in lists. Null if
/// there is none.
const Figure* find_figure(const ResultTree& tree, std::string_view path);

/// The value as people read it, without unit; `dash` where there is none, or nobody can tell it.
std::string shown_value(const Figure& figure, const char* dash = "–");
/// "61.4 to 113" with " to " as `between`; `dash` where there is none, or its ends are equal.
std::string shown_interval(const Figure& figure, const char* between, const char* dash = "–");
/// "83.2 kPa".
std::string shown_with_unit(const Figure& figure);
/// Title and value of every figure with a title, from outside lists and without estimates: "Mesh"
/// and "4,312 nodes".
std::vector<std::pair<std::string, std::string>> titled_rows(const ResultTree& tree);

}  // namespace palpate
