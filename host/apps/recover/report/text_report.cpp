// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/text_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/apps/recover/report/findings.hpp"
#include "host/apps/recover/report/recovery_tree.hpp"
#include "host/page/plain_text.hpp"
#include "host/page/tree_table.hpp"

namespace palpate {
namespace {

/// Of the Poisson's ratios that were searched; empty if there are none.
std::string ratios_table(const ResultTree& regions) {
    const TreeTable table = table_of(regions, {"name", "searched_poisson_ratio"}, "-");
    return table.columns.size() > 1 ? '\n' + table.text() : "";
}

/// Figures that nothing else here tells, a line each.
std::string more_figures(const RecoveryResult& result) {
    std::string out;
    for (const auto& [title, value] : titled_rows(recovery_tree(result)))
        out += harmless(title + ": " + value) + '\n';
    return out;
}

std::string surfaces_table(const RecoveryResult& result) {
    TextTable table({"Surface", "Role", "Dice before", "after", "Mean mm before", "after",
                     "Max mm before", "after"},
                    {false, false, true, true, true, true, true, true});
    for (const SurfaceResult& s : result.surfaces)
        table.add({harmless(s.name) + (s.cut_by_image ? " *" : ""), name_of(s.role),
                   decimals_or_dash(s.dice_before, 3), decimals_or_dash(s.dice_after, 3),
                   decimals_or_dash(s.mean_distance_mm_before, 2),
                   decimals_or_dash(s.mean_distance_mm_after, 2),
                   decimals_or_dash(s.max_distance_mm_before, 2),
                   decimals_or_dash(s.max_distance_mm_after, 2)});
    return table.text();
}

}  // namespace

std::string text_report(const RecoveryResult& result) {
    const ResultTree regions = regions_tree(result.regions);
    std::string out = table_of(regions, {"name", "label", "role", "stiffness_kpa"}, "-").text() +
                      ratios_table(regions);
    for (const RegionResult& r : result.regions)
        if (const std::string bound = bound_text(r); !bound.empty())
            out += harmless(r.name + ": " + bound) + ".\n";
    if (!result.surfaces.empty()) out += '\n' + surfaces_table(result);
    if (std::any_of(result.surfaces.begin(), result.surfaces.end(),
                    [](const SurfaceResult& s) { return s.cut_by_image; }))
        out += "* cut by the field of view; the cut face carries no data\n";
    if (const std::string text = landmark_sentence(result); !text.empty()) out += text + '\n';
    if (const std::string seen = seen_sentence(result); !seen.empty()) out += harmless(seen) + '\n';
    if (const std::string text = contours_sentence(result); !text.empty()) out += text + '\n';
    out += '\n' + law_sentence(result) + '\n';
    out += more_figures(result);
    for (const std::string& warning : result.warnings)
        out += "Warning: " + harmless(warning) + '\n';
    if (const std::string solvers = linear_solvers_text(result); !solvers.empty())
        out += "Linear solvers, " + harmless(solvers) + '\n';
    return out + harmless(termination_sentence(result)) + '\n';
}

std::string convergence_csv(const RecoveryResult& result) {
    std::string out = "iteration,objective,gradient_norm,step";
    std::size_t num_unknown = 0;
    for (const RegionResult& r : result.regions) {
        if (!r.unknown) continue;
        out += ',' + csv_text("stiffness_kpa " + r.name);
        ++num_unknown;
    }
    out += '\n';
    for (const IterationRecord& i : result.convergence) {
        out += fmt::format("{},{},{},{}", i.iteration, csv_number(i.objective),
                           csv_number(i.gradient_norm), csv_number(i.step));
        for (std::size_t u = 0; u < num_unknown; ++u)
            out += ',' + (u < i.stiffness_kpa.size() ? csv_number(i.stiffness_kpa[u]) : "");
        out += '\n';
    }
    return out;
}

}  // namespace palpate
