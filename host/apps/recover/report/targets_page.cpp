// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/targets_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/apps/recover/report/findings.hpp"
#include "host/apps/recover/report/html_tables.hpp"
#include "host/page/figure_html.hpp"
#include "host/page/interval_chart.hpp"
#include "host/page/markup.hpp"
#include "host/page/page.hpp"

namespace palpate {
namespace {

bool is_joint(const TargetRow& row) { return row.name == joint_row_name; }

const TargetRow* joint_of(const std::vector<TargetRow>& rows) {
    for (const TargetRow& row : rows)
        if (is_joint(row) && !row.unknown.empty()) return &row;
    return nullptr;
}

/// Regions in the order in which rows name them first.
std::vector<std::string> region_names(const std::vector<TargetRow>& rows) {
    std::vector<std::string> names;
    for (const TargetRow& row : rows)
        for (const RegionResult& region : row.unknown)
            if (std::find(names.begin(), names.end(), region.name) == names.end())
                names.push_back(region.name);
    return names;
}

const RegionResult* find_region(const TargetRow& row, const std::string& name) {
    for (const RegionResult& region : row.unknown)
        if (region.name == name) return &region;
    return nullptr;
}

std::string chart_of(const std::vector<TargetRow>& rows, const std::string& name) {
    std::vector<IntervalBar> bars;
    for (const TargetRow& row : rows) {
        const RegionResult* region = find_region(row, name);
        if (!region || !(region->interval_kpa[0] > 0)) continue;
        const auto& [low, high] = region->interval_kpa;
        bars.push_back({row.name, is_known(*region) ? region->stiffness_kpa : NAN,
                        std::pair{low, high},
                        is_joint(row)       ? "var(--accent)"
                        : is_known(*region) ? "var(--soft)"
                                            : "var(--line)"});
    }
    if (bars.empty()) return "";
    return fmt::format(
        "<figure>{}<figcaption>{}: what each target tells, and, in colour, what they tell "
        "together. Pale: not identifiable from that target alone.</figcaption></figure>",
        interval_chart(bars, "Young's modulus E, kPa", name + ": 95 % intervals by target"),
        escape_html(name));
}

std::string cells_of(const RegionResult& region) {
    return fmt::format("<td>{}</td><td class='num'>{}</td><td class='num'>{} – {}</td><td>{}</td>",
                       escape_html(region.name),
                       is_known(region) ? significant(region.stiffness_kpa) : "–",
                       significant(region.interval_kpa[0]), significant(region.interval_kpa[1]),
                       verdict_chip(name_of(region.verdict)));
}

std::string name_cell(const TargetRow& row, std::size_t lines) {
    const std::string name = escape_html(row.name);
    const bool has_report = !is_joint(row) && std::isfinite(row.seconds);
    return fmt::format("<td rowspan='{}'>{}</td>", std::max<std::size_t>(lines, 1),
                       has_report ? fmt::format("<a href='{0}/report.html'>{0}</a>", name) : name);
}

std::string table_of(const std::vector<TargetRow>& rows) {
    std::string out =
        "<div class='scroll'><table><thead><tr><th>Target</th><th>Region</th><th class='num'>E, "
        "kPa</th><th class='num'>95 % interval, kPa</th><th>Verdict</th></tr></thead><tbody>";
    for (const TargetRow& row : rows) {
        out += "<tr>" + name_cell(row, row.unknown.size());
        for (std::size_t k = 0; k < row.unknown.size(); ++k)
            out += (k > 0 ? "<tr>" : "") + cells_of(row.unknown[k]) + "</tr>";
        if (row.unknown.empty())
            out += "<td colspan='3'></td><td>" + verdict_chip("failed") + "</td></tr>";
    }
    return out + "</tbody></table></div>";
}

std::string notes_of(const std::vector<TargetRow>& rows) {
    std::string out;
    for (const TargetRow& row : rows)
        if (!row.note.empty())
            out += fmt::format("<p class='{}'>{}: {}</p>", is_joint(row) ? "caption" : "notice",
                               escape_html(row.name), escape_html(row.note));
    return out;
}

std::string headline_of(const std::vector<TargetRow>& rows) {
    const TargetRow* joint = joint_of(rows);
    if (!joint) return "What each target tells";
    std::string out;
    for (const RegionResult& region : joint->unknown) {
        out += (out.empty() ? "" : "; ") + region.name + ": ";
        const std::string bound = bound_text(region);
        out += !bound.empty() ? bound
               : is_known(region)
                   ? fmt::format(
                         "{} kPa (95 % interval {} to {} kPa)", significant(region.stiffness_kpa),
                         significant(region.interval_kpa[0]), significant(region.interval_kpa[1]))
                   : "not identifiable";
    }
    return out;
}

std::string summary_of(const std::vector<TargetRow>& rows) {
    if (joint_of(rows))
        return "One modulus for all targets of this patient, the reference's contours common to "
               "all. Targets on both sides of the reference tell most: what its contours are off "
               "cancels.";
    return "Each target by itself. A joint estimate is made of two and more that converged and "
           "tell something of their own.";
}

}  // namespace

std::string targets_page(const std::vector<TargetRow>& rows, const std::string& version) {
    std::string charts;
    for (const std::string& name : region_names(rows)) charts += chart_of(rows, name);
    const std::string table =
        table_of(rows) + notes_of(rows) +
        "<p class='caption'>The same numbers are in <code>targets.csv</code>.</p>";
    return page_html(
        {.kind = "Stiffness from several targets of one patient",
         .version = version,
         .headline = escape_html(headline_of(rows)),
         .lead = "<p class='summary'>" + escape_html(summary_of(rows)) + "</p>",
         .main = "<section>" + charts + "</section>" + section_html("targets", "By target", table),
         .footer = "Moduli are Young's moduli in kPa."});
}

}  // namespace palpate
