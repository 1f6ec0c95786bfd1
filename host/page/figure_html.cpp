// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/figure_html.hpp"

#include <fmt/format.h>

#include "host/page/markup.hpp"

namespace palpate {
namespace {

/// The class of page.css that colours a verdict.
const char* chip_class(const std::string& words) {
    if (words == name_of(Verdict::recovered)) return "good";
    if (words == name_of(Verdict::weak)) return "weak";
    return words == name_of(Verdict::not_identifiable) ? "bad" : "plain";
}

}  // namespace

std::string verdict_chip(const std::string& words) {
    return fmt::format("<span class='chip {}'>{}</span>", chip_class(words), escape_html(words));
}

std::string facts_html(const std::vector<std::pair<std::string, std::string>>& rows) {
    std::string out = "<dl>";
    for (const auto& [name, value] : rows)
        if (!value.empty())
            out += fmt::format("<dt>{}</dt><dd>{}</dd>", escape_html(name), escape_html(value));
    return out + "</dl>";
}

std::string estimate_card(const Figure& figure, const std::string& heading_html,
                          std::string_view colour, std::string_view note_html) {
    std::string out = fmt::format("<article class='finding' style='--organ:{}'><h3>{}</h3>", colour,
                                  heading_html);
    const std::string interval = escape_html(shown_interval(figure, " – "));
    if (figure.verdict == Verdict::not_identifiable) {
        out += "<p class='value'>–</p>";
    } else {
        const std::string unit = escape_html(figure.unit);
        const std::string small = unit.empty() ? "" : fmt::format(" <small>{}</small>", unit);
        out += fmt::format("<p class='value'>{}{}</p>", escape_html(shown_value(figure)), small);
        if (figure.interval_95)
            out +=
                fmt::format("<p>95 % interval {}{}{}</p>", interval, unit.empty() ? "" : " ", unit);
        out += note_html;
    }
    if (figure.verdict) out += fmt::format("<p>{}</p>", verdict_chip(name_of(*figure.verdict)));
    if (!figure.reason.empty())
        out += fmt::format("<p class='reason'>{}</p>", escape_html(figure.reason));
    return out + "</article>";
}

}  // namespace palpate
