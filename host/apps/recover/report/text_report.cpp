// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/text_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/apps/recover/report/findings.hpp"
#include "host/page/plain_text.hpp"

namespace palpate {
namespace {

std::string regions_table(const RecoveryResult& result) {
    TextTable table({"Region", "Label", "Role", "Stiffness kPa", "95 % interval", "Verdict"},
                    {false, true, false, true, true, false});
    for (const RegionResult& r : result.regions) {
        const std::string interval =
            fmt::format("{} to {}", significant(r.interval_kpa[0]), significant(r.interval_kpa[1]));
        table.add({harmless(r.name), fmt::format("{}", r.label), r.role,
                   r.hollow ? "-" : significant(r.stiffness_kpa), r.unknown ? interval : "-",
                   r.verdict});
    }
    return table.text();
}

/// Of the Poisson's ratios that were searched; empty if there are none.
std::string ratios_table(const RecoveryResult& result) {
    TextTable table({"Region", "Poisson's ratio", "95 % interval", "Verdict"},
                    {false, true, true, false});
    bool any = false;
    for (const RegionResult& r : result.regions) {
        if (!r.ratio) continue;
        any = true;
        table.add({harmless(r.name), decimals(r.poisson_ratio, 2),
                   fmt::format("{} to {}", decimals(r.ratio->interval[0], 2),
                               decimals(r.ratio->interval[1], 2)),
                   r.ratio->verdict});
    }
    return any ? '\n' + table.text() : "";
}

std::string surfaces_table(const RecoveryResult& result) {
    TextTable table({"Surface", "Role", "Dice before", "after", "Mean mm before", "after",
                     "Max mm before", "after"},
                    {false, false, true, true, true, true, true, true});
    for (const SurfaceResult& s : result.surfaces)
        table.add({harmless(s.name) + (s.cut_by_image ? " *" : ""), s.role,
                   decimals_or_dash(s.dice_before, 3), decimals_or_dash(s.dice_after, 3),
                   decimals_or_dash(s.mean_distance_mm_before, 2),
                   decimals_or_dash(s.mean_distance_mm_after, 2),
                   decimals_or_dash(s.max_distance_mm_before, 2),
                   decimals_or_dash(s.max_distance_mm_after, 2)});
    return table.text();
}

}  // namespace

std::string text_report(const RecoveryResult& result) {
    std::string out = regions_table(result) + ratios_table(result);
    if (!result.surfaces.empty()) out += '\n' + surfaces_table(result);
    if (std::any_of(result.surfaces.begin(), result.surfaces.end(),
                    [](const SurfaceResult& s) { return s.cut_by_image; }))
        out += "* cut by the field of view; the cut face carries no data\n";
    if (const std::string text = landmark_sentence(result); !text.empty()) out += text + '\n';
    if (const std::string seen = seen_sentence(result); !seen.empty()) out += harmless(seen) + '\n';
    out += '\n' + law_sentence(result) + '\n';
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
