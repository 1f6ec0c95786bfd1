// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/tree_html.hpp"

#include <fmt/format.h>

#include <vector>

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

std::vector<std::string> parts_html(const ResultTree& tree) {
    std::vector<std::string> parts;
    for (const ResultTree* part : tree.parts())
        if (!part->title.empty())
            parts.push_back(fmt::format("<section><h2>{}</h2>{}</section>",
                                        escape_html(part->title), tree_html(*part)));
    return parts;
}

}  // namespace

std::string tree_html(const ResultTree& tree) {
    if (tree.shape == ResultTree::Shape::list) return table_of(tree).html();
    std::string html = own_figures_html(tree);
    for (const std::string& part : parts_html(tree)) html += part;
    return html;
}

std::string tree_sections_html(const ResultTree& tree, const std::string& pictures_html) {
    std::vector<std::string> sections;
    if (tree.shape == ResultTree::Shape::list) {
        sections.push_back("<section>" + tree_html(tree) + "</section>");
    } else {
        sections = parts_html(tree);
        const std::string own = own_figures_html(tree);
        if (!own.empty()) sections.insert(sections.begin(), "<section>" + own + "</section>");
    }
    sections.insert(sections.begin() + (sections.empty() ? 0 : 1), pictures_html);
    std::string html;
    for (const std::string& section : sections) html += section;
    return html;
}

}  // namespace palpate
