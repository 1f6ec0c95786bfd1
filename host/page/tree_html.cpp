// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/tree_html.hpp"

#include <fmt/format.h>

#include "host/page/figure_html.hpp"
#include "host/page/markup.hpp"
#include "host/page/tree_table.hpp"

namespace palpate {
namespace {

/// The figures of one object, not of its parts.
std::string own_figures_html(const ResultTree& tree) {
    std::string cards;
    std::vector<std::pair<std::string, std::string>> rows;
    for (const Figure* figure : tree.figures()) {
        if (figure->title.empty()) continue;
        if (figure->is_estimate())
            cards += estimate_card(*figure, escape_html(figure->title), list_colour(0));
        else
            rows.emplace_back(figure->title, shown_with_unit(*figure));
    }
    if (!cards.empty()) cards = "<div class='findings'>" + cards + "</div>";
    return rows.empty() ? cards : cards + facts_html(rows);
}

std::string parts_html(const ResultTree& tree) {
    std::string out;
    for (const ResultTree* part : tree.parts())
        if (!part->title.empty())
            out += fmt::format("<section><h2>{}</h2>{}</section>", escape_html(part->title),
                               tree_html(*part));
    return out;
}

}  // namespace

std::string tree_html(const ResultTree& tree) {
    if (tree.shape == ResultTree::Shape::list) return table_of(tree).html();
    return own_figures_html(tree) + parts_html(tree);
}

std::string tree_sections_html(const ResultTree& tree) {
    if (tree.shape == ResultTree::Shape::list) return "<section>" + tree_html(tree) + "</section>";
    const std::string own = own_figures_html(tree);
    return (own.empty() ? "" : "<section>" + own + "</section>") + parts_html(tree);
}

}  // namespace palpate
