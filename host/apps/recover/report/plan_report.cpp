// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/plan_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "host/apps/recover/report/findings.hpp"
#include "host/page/plain_text.hpp"

namespace palpate {
namespace {

std::string title_of(const PlannedInterval& interval) {
    if (interval.emptier == 0)
        return interval.fuller == 1 ? "1 target" : fmt::format("{} on one side", interval.fuller);
    return fmt::format("{} + {} on both sides", interval.fuller, interval.emptier);
}

}  // namespace

double interval_factor(const PlannedInterval& interval) {
    return std::exp(2 * 1.96 * interval.sd_ln);
}

std::string plan_table(const std::vector<PlanRow>& rows) {
    if (rows.empty()) return "";
    std::vector<std::string> header{"Region", "If kPa", "Moves mm"};
    std::vector<bool> to_the_right{false, true, true};
    for (const PlannedInterval& interval : rows.front().intervals) {
        header.push_back(title_of(interval));
        to_the_right.push_back(true);
    }
    TextTable table(header, to_the_right);
    for (const PlanRow& row : rows) {
        std::vector<std::string> cells{harmless(row.region), significant(row.supposed_kpa),
                                       decimals(row.moved_mm, 1)};
        for (const PlannedInterval& interval : row.intervals)
            cells.push_back(interval.is_identifiable
                                ? fmt::format("x {}", significant(interval_factor(interval)))
                                : "nothing");
        table.add(std::move(cells));
    }
    return table.text();
}

ResultTree plan_tree(const std::vector<PlanRow>& rows, double motion_mm, double contour_mm) {
    ResultTree tree = ResultTree::of("plan", {{"format", "palpate-plan"},
                                              {"format_version", 1},
                                              {"motion_mm", motion_mm},
                                              {"contour_sd_mm", contour_mm}});
    ResultTree& list = tree.add_part("regions", ResultTree::Shape::list);
    for (const PlanRow& row : rows) {
        ResultTree part = ResultTree::of(
            row.region,
            {{"name", row.region}, {"supposed_kpa", row.supposed_kpa}, {"moved_mm", row.moved_mm}});
        ResultTree& intervals = part.add_part("intervals", ResultTree::Shape::list);
        for (const PlannedInterval& interval : row.intervals)
            intervals.add(ResultTree::of("", {{"targets_fuller", interval.fuller},
                                              {"targets_emptier", interval.emptier},
                                              {"sd_ln_stiffness", interval.sd_ln},
                                              {"factor_95", interval_factor(interval)},
                                              {"identifiable", interval.is_identifiable}}));
        list.add(std::move(part));
    }
    return tree;
}

}  // namespace palpate
