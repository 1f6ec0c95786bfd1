// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/legend.hpp"

#include <fmt/format.h>

#include "host/page/markup.hpp"

namespace palpate {

std::string legend_html(const std::vector<LegendEntry>& entries) {
    std::string out = "<div class='legend'>";
    for (const LegendEntry& entry : entries)
        out += fmt::format(
            "<span><i{} style='{}:{}'></i>{}</span>", entry.is_hollow ? " class='hollow'" : "",
            entry.is_hollow ? "border-color" : "background", entry.colour, escape_html(entry.text));
    return out + "</div>";
}

}  // namespace palpate
