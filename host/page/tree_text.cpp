// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/tree_text.hpp"

#include "host/page/plain_text.hpp"
#include "host/page/tree_table.hpp"

namespace palpate {
namespace {

/// "Stiffness: 83.2 kPa (95 % interval 61.4 to 113). Verdict: recovered: why".
std::string figure_line(const Figure& figure) {
    std::string line = figure.title + ": " + shown_with_unit(figure);
    if (figure.interval_95) line += " (95 % interval " + shown_interval(figure, " to ") + ")";
    if (figure.verdict) line += std::string(". Verdict: ") + name_of(*figure.verdict);
    if (figure.verdict && !figure.reason.empty()) line += ": " + figure.reason;
    return harmless(line) + '\n';
}

}  // namespace

std::string tree_text(const ResultTree& tree) {
    if (tree.shape == ResultTree::Shape::list) return table_of(tree).text();
    std::string out;
    for (const Figure* figure : tree.figures())
        if (!figure->title.empty()) out += figure_line(*figure);
    for (const ResultTree* part : tree.parts())
        if (!part->title.empty())
            out.append(out.empty() ? "" : "\n")
                .append(harmless(part->title) + '\n')
                .append(tree_text(*part));
    return out;
}

}  // namespace palpate
