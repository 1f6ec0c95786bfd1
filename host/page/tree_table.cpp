// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/tree_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host/page/figure_html.hpp"
#include "host/page/markup.hpp"
#include "host/page/plain_text.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

const Figure* figure_named(const ResultTree& part, const std::string& name) {
    for (const Figure* figure : part.figures())
        if (figure->name == name) return figure;
    return nullptr;
}

bool is_null(const Figure& figure) { return std::holds_alternative<std::monostate>(figure.value); }

bool is_words(const Figure& figure) {
    return std::holds_alternative<std::string>(figure.value) ||
           std::holds_alternative<bool>(figure.value);
}

/// What a column tells of a figure.
using Cell = std::string (*)(const Figure& figure, const char* dash);

struct PlannedColumn {
    std::string name;  ///< of the figure
    TreeTable::Column column;
    Cell cell;
};

std::string verdict_cell(const Figure& figure, const char* dash) {
    return figure.verdict ? name_of(*figure.verdict) : dash;
}

/// The columns of one figure, whose value some part has.
void plan_columns(const ResultTree& list, const std::string& name,
                  std::vector<PlannedColumn>& planned) {
    const Figure* shown = nullptr;
    bool has_interval = false, has_verdict = false;
    for (const ResultTree* part : list.parts()) {
        const Figure* figure = figure_named(*part, name);
        if (!figure || is_null(*figure)) continue;
        if (!shown) shown = figure;
        has_interval = has_interval || figure->interval_95;
        has_verdict = has_verdict || figure->verdict;
    }
    if (!shown) return;
    planned.push_back({name, {shown->title, shown->unit, !is_words(*shown), false}, &shown_value});
    if (has_interval)
        planned.push_back(
            {name, {"95 % interval", "", true, false}, [](const Figure& figure, const char* dash) {
                 return shown_interval(figure, " to ", dash);
             }});
    if (has_verdict) planned.push_back({name, {"Verdict", "", false, true}, &verdict_cell});
}

}  // namespace

TreeTable table_of(const ResultTree& list, const std::vector<std::string>& names,
                   const char* dash) {
    std::vector<PlannedColumn> planned;
    for (const std::string& name : names) plan_columns(list, name, planned);
    TreeTable table;
    for (const PlannedColumn& plan : planned) table.columns.push_back(plan.column);
    for (const ResultTree* part : list.parts()) {
        std::vector<std::string> line;
        bool says_something = planned.size() < 2;
        for (const PlannedColumn& plan : planned) {
            const Figure* figure = figure_named(*part, plan.name);
            const bool is_there = figure && !is_null(*figure);
            line.push_back(is_there ? plan.cell(*figure, dash) : dash);
            says_something = says_something || (is_there && &plan != planned.data());
        }
        if (!says_something) continue;
        table.lines.push_back(std::move(line));
        table.parts.push_back(part);
    }
    return table;
}

TreeTable table_of(const ResultTree& list) {
    std::vector<std::string> names;
    for (const ResultTree* part : list.parts())
        for (const Figure* figure : part->figures())
            if (!figure->title.empty() &&
                std::find(names.begin(), names.end(), figure->name) == names.end())
                names.push_back(figure->name);
    return table_of(list, names);
}

std::string TreeTable::text() const {
    std::vector<std::string> header;
    std::vector<bool> to_the_right;
    for (const Column& column : columns) {
        header.push_back(
            harmless(column.unit.empty() ? column.title : column.title + " " + column.unit));
        to_the_right.push_back(column.is_number);
    }
    TextTable table(header, to_the_right);
    for (std::vector<std::string> line : lines) {
        for (std::string& cell : line) cell = harmless(cell);
        table.add(std::move(line));
    }
    return table.text();
}

std::string TreeTable::html(const std::function<std::string(const ResultTree&)>& mark_html) const {
    const auto cell = [](const char* tag, const Column& column, const std::string& content) {
        return fmt::format("<{0}{1}>{2}</{0}>", tag, column.is_number ? " class='num'" : "",
                           content);
    };
    std::string out = "<div class='scroll'><table><thead><tr>";
    for (const Column& column : columns)
        out += cell(
            "th", column,
            escape_html(column.unit.empty() ? column.title : column.title + ", " + column.unit));
    out += "</tr></thead><tbody>";
    for (std::size_t k = 0; k < lines.size(); ++k) {
        out += "<tr>";
        for (std::size_t c = 0; c < columns.size(); ++c) {
            std::string content = c == 0 && mark_html ? mark_html(*parts[k]) : "";
            const bool is_chip = columns[c].is_verdict && lines[k][c] != "–";
            content += is_chip ? verdict_chip(lines[k][c]) : escape_html(lines[k][c]);
            out += cell("td", columns[c], content);
        }
        out += "</tr>";
    }
    return out + "</tbody></table></div>";
}

std::size_t TreeTable::column(const std::string& title) const {
    for (std::size_t c = 0; c < columns.size(); ++c)
        if (columns[c].title == title) return c;
    throw Error(ErrorCode::internal, "a table has no column '" + title + "'");
}

}  // namespace palpate
