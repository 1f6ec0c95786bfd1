// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/apps/study/figures.hpp"
#include "host/page/markup.hpp"

namespace palpate {
namespace {

/// Characters as a terminal counts them: bytes that do not continue one.
std::size_t width_of(const std::string& text) {
    return std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; });
}

std::string html_line(const std::vector<std::string>& cells, const char* tag) {
    std::string out = "<tr>";
    for (std::size_t c = 0; c < cells.size(); ++c)
        out += fmt::format("<{0}{1}>{2}</{0}>", tag, c > 0 ? " class='num'" : "",
                           escape_html(cells[c]));
    return out + "</tr>";
}

std::string group_line(const std::vector<std::pair<std::string, std::size_t>>& groups) {
    if (groups.empty()) return "";
    std::string out = "<tr><th></th>";
    for (const auto& [title, columns] : groups)
        out += fmt::format("<th class='group' colspan='{}'>{}</th>", columns, escape_html(title));
    return out + "</tr>";
}

std::vector<std::string> error_cells(const Accuracy& group) {
    return {fmt::format("{}", group.count), percent(group.median_abs_error_percent),
            signed_percent(group.mean_signed_error_percent),
            percent(group.worst_abs_error_percent)};
}

}  // namespace

std::string StudyTable::html(const std::string& css_class) const {
    std::string out =
        fmt::format("<div class='scroll'><table class='{}'><thead>{}{}</thead><tbody>", css_class,
                    group_line(groups), html_line(header, "th"));
    for (const auto& line : lines) out += html_line(line, "td");
    return out + "</tbody></table></div>";
}

std::string StudyTable::plain() const {
    std::vector<std::size_t> width(header.size(), 0);
    std::vector<std::vector<std::string>> all{header};
    all.insert(all.end(), lines.begin(), lines.end());
    for (const auto& line : all)
        for (std::size_t c = 0; c < line.size(); ++c)
            width[c] = std::max(width[c], width_of(line[c]));
    std::string out;
    for (const auto& line : all) {
        for (std::size_t c = 0; c < line.size(); ++c) {
            const std::string room(width[c] - width_of(line[c]), ' ');
            out += c == 0 ? line[c] + room : "   " + room + line[c];
        }
        out += "\n";
    }
    return out;
}

std::string percent(double value) { return fmt::format("{:.1f} %", value); }

std::string signed_percent(double value) {
    return fmt::format("{}{:.1f} %", value < 0 ? "−" : "+", std::abs(value));
}

std::string holding_text(const Accuracy& accuracy) {
    if (accuracy.num_intervals == 0) return "–";
    return fmt::format("{} of {} ({:.0f} to {:.0f} %)", accuracy.num_holding,
                       accuracy.num_intervals, 100 * accuracy.holding_range[0],
                       100 * accuracy.holding_range[1]);
}

StudyTable accuracy_table(const std::vector<Accuracy>& ours,
                          const std::vector<Accuracy>& published) {
    const std::vector<std::string> errors{"cases", "median |error|", "mean error", "worst |error|"};
    StudyTable table;
    table.header = {"true stiffness"};
    table.header.insert(table.header.end(), errors.begin(), errors.end());
    table.header.push_back("intervals that hold the truth");
    if (!published.empty()) {
        table.header.insert(table.header.end(), errors.begin(), errors.end());
        table.groups = {{"palpate", errors.size() + 1}, {"published", errors.size()}};
    }
    for (const Accuracy& group : ours) {
        std::vector<std::string> line{group.name};
        const auto add = [&](const std::vector<std::string>& cells) {
            line.insert(line.end(), cells.begin(), cells.end());
        };
        add(error_cells(group));
        add({holding_text(group)});
        for (const Accuracy& theirs : published)
            if (theirs.name == group.name) add(error_cells(theirs));
        line.resize(table.header.size(), "–");
        table.lines.push_back(line);
    }
    return table;
}

std::string other_mesh_note() {
    return "The truths obey the elastic law that the recovery assumes, on another mesh: the errors "
           "are those of voxels, mesh and unknown wall motion, not of tissue that behaves "
           "otherwise.";
}

StudySection accuracy_section(const std::vector<Estimate>& ours,
                              const std::vector<Estimate>& published, const std::string& x_label,
                              const std::string& note) {
    const auto theirs = published.empty() ? std::vector<Accuracy>{} : accuracy_by_group(published);
    StudySection section;
    section.title =
        published.empty() ? "Truth and estimate" : "Truth and estimate, beside published values";
    section.pictures = {recovered_picture(ours, published, x_label),
                        error_picture(ours, published, x_label)};
    section.html = accuracy_table(accuracy_by_group(ours), theirs).html("beside");
    section.html +=
        "<p class='caption'>Error: recovered over expected stiffness, minus one. In brackets: 95 % "
        "range of the share of intervals that hold the truth (Clopper and Pearson); 95 % is aimed "
        "at.</p>";
    section.html += "<p class='caption'>" + escape_html(note) + "</p>";
    if (!published.empty())
        section.html += "<p class='caption'>" + escape_html(published_source()) + "</p>";
    return section;
}

}  // namespace palpate
