// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/html_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/apps/recover/report/findings.hpp"
#include "host/apps/recover/report/recovery_tree.hpp"
#include "host/page/figure_html.hpp"
#include "host/page/markup.hpp"
#include "host/page/tree_table.hpp"

namespace palpate {
namespace {

std::string swatch(const RecoveryResult& result, Index region) {
    return fmt::format("<i class='swatch' style='background:{}'></i>",
                       region_colour(result, region));
}

std::string ratio_text(const RecoveryResult& result, const RegionResult& r) {
    const RegionResult* known = reference_tissue(result);
    if (!known) return "";
    return fmt::format("<p>{} × {} ({} kPa, given)</p>",
                       significant(r.stiffness_kpa / known->stiffness_kpa),
                       escape_html(known->name), significant(known->stiffness_kpa));
}

/// "−12 to +8 %".
std::string volume_change_cell(const RegionResult& r) {
    const auto percent = [](double jacobian) {
        const double change = 100 * (jacobian - 1);
        return (change < 0 ? "−" : "+") + decimals(std::abs(change), 0);
    };
    return percent(r.jacobian_range[0]) + " to " + percent(r.jacobian_range[1]) + " %";
}

/// Of the regions that are meshed.
std::string deformation_table(const RecoveryResult& result) {
    std::string out =
        "<table class='narrow'><thead><tr><th>Region</th><th class='num'>Change of volume</th>"
        "<th class='num'>Strain energy, mJ</th></tr></thead><tbody>";
    bool is_folded = false;
    for (const RegionResult& r : result.regions) {
        if (r.hollow) continue;
        is_folded = is_folded || r.jacobian_range[0] <= 0;
        out += fmt::format("<tr><td>{}{}</td><td class='num'>{}</td><td class='num'>{}</td></tr>",
                           swatch(result, r.region), escape_html(r.name), volume_change_cell(r),
                           significant(r.strain_energy_mj));
    }
    out +=
        "</tbody></table><p class='caption'>Change of volume of the elements, smallest to "
        "largest.";
    if (is_folded)
        out +=
            " Below −100 % an element is turned inside out, which linear elasticity does not "
            "forbid: the motion is large for it, and neo-hookean tissue worth trying.";
    return out + "</p>";
}

std::string before_after_cells(double before, double after, int digits) {
    return fmt::format("<td class='num from'>{}</td><td class='num'>{}</td>",
                       decimals_or_dash(before, digits), decimals_or_dash(after, digits));
}

std::string alignment_text(const AlignmentResult& a) {
    const double cosine = std::clamp((a.reference_to_target.rotation.trace() - 1) / 2, -1.0, 1.0);
    const Vec3& t = a.reference_to_target.translation;
    std::string text = fmt::format("{}: shift ({}, {}, {}) mm LPS, rotation {}°", a.method,
                                   decimals(t.x(), 2), decimals(t.y(), 2), decimals(t.z(), 2),
                                   decimals(std::acos(cosine) * 180 / std::numbers::pi, 2));
    if (a.moved_mm > 0 || a.turned_deg > 0)
        text += fmt::format("; of this, the search itself moved it by {} mm and {}°",
                            decimals(a.moved_mm, 2), decimals(a.turned_deg, 2));
    return text;
}

std::string device_text(const BackendInfo& d) {
    std::string text = d.backend;
    if (!d.device.empty()) text += ", " + d.device;
    if (!d.platform.empty()) text += " (" + d.platform + ")";
    text += d.precision == Precision::single ? ", single precision with double refinement"
                                             : ", double precision";
    return text;
}

std::string timings_table(const RecoveryResult& result) {
    std::string out =
        "<table class='narrow'><thead><tr><th>Stage</th><th class='num'>Time, s</th>"
        "</tr></thead><tbody>";
    for (const auto& [stage, seconds] : result.timings_s)
        out += fmt::format("<tr><td>{}</td><td class='num'>{}</td></tr>", escape_html(stage),
                           decimals(seconds, 2));
    return out + fmt::format(
                     "</tbody><tfoot><tr><td>total</td><td class='num'>{}</td></tr></tfoot>"
                     "</table>",
                     decimals(total_seconds(result), 2));
}

/// Escaped names of the unknown regions, `count` of them.
std::vector<std::string> unknown_names(const RecoveryResult& result, std::size_t count) {
    std::vector<std::string> names;
    for (const RegionResult& r : result.regions)
        if (r.unknown) names.push_back(escape_html(r.name));
    names.resize(count, "?");
    return names;
}

std::string number_headers(const std::vector<std::string>& names) {
    std::string out;
    for (const std::string& name : names) out += "<th class='num'>" + name + "</th>";
    return out;
}

std::string number_cells(const std::vector<double>& values) {
    std::string out;
    for (const double value : values) out += "<td class='num'>" + decimals(value, 2) + "</td>";
    return out;
}

}  // namespace

std::string headline_html(const RecoveryResult& result) {
    std::vector<std::string> parts;
    for (const RegionResult& r : result.regions) {
        if (!r.unknown) continue;
        parts.push_back(r.verdict == Verdict::not_identifiable
                            ? r.name + " not identifiable"
                            : r.name + " " + significant(r.stiffness_kpa) + " kPa");
    }
    if (parts.empty()) return "Deformation and forces; no modulus was unknown";
    std::string text;
    for (std::size_t i = 0; i < parts.size(); ++i) text += (i ? " · " : "") + parts[i];
    return escape_html("Stiffness: " + text);
}

std::string findings_html(const RecoveryResult& result) {
    const ResultTree regions = regions_tree(result.regions);
    const auto card = [&](std::size_t k, const char* name, const std::string& heading_html,
                          const std::string& note_html) {
        return estimate_card(*find_figure(regions, fmt::format("{}/{}", k, name)), heading_html,
                             region_colour(result, result.regions[k].region), note_html);
    };
    std::string moduli, ratios;
    for (std::size_t k = 0; k < result.regions.size(); ++k) {
        const RegionResult& r = result.regions[k];
        if (r.unknown)
            moduli += card(k, "stiffness_kpa", escape_html(r.name), ratio_text(result, r));
        if (r.ratio)
            ratios +=
                card(k, "searched_poisson_ratio", escape_html(r.name) + ", Poisson's ratio", "");
    }
    return moduli + ratios;
}

std::string notices_html(const RecoveryResult& result) {
    std::string out;
    if (!result.termination.converged)
        out += fmt::format(
            "<p class='notice bad'><b>Not converged.</b> The search ended before the "
            "minimum was reached ({}). Do not rely on the values below.</p>",
            escape_html(result.termination.reason));
    for (const std::string& warning : result.warnings)
        out += fmt::format("<p class='notice'><b>Warning.</b> {}</p>", escape_html(warning));
    return out;
}

std::string regions_table_html(const RecoveryResult& result) {
    const ResultTree regions = regions_tree(result.regions);
    TreeTable table = table_of(
        regions, {"name", "label", "role", "poisson_ratio", "stiffness_kpa", "shear_modulus_kpa"});
    for (std::size_t k = 0; k < table.lines.size(); ++k)
        if (const Figure* searched = find_figure(*table.parts[k], "searched_poisson_ratio");
            searched->is_estimate())
            table.lines[k][table.column("Poisson's ratio")] +=
                " (" + shown_interval(*searched, " – ") + ")";
    const auto mark = [&](const ResultTree& part) {
        const auto at = std::find_if(result.regions.begin(), result.regions.end(),
                                     [&](const RegionResult& r) { return r.name == part.name; });
        return swatch(result, at->region);
    };
    return table.html(mark) + deformation_table(result);
}

/// Size of the force with its 95 % interval along its own direction, N.
std::string force_cell(const SurfaceResult& s) {
    const double size = s.resultant_force_mn.norm();
    if (size == 0) return decimals(0, 3);
    const double sd = s.resultant_sd_mn.cwiseProduct(s.resultant_force_mn).norm() / size;
    return decimals(size / 1000, 3) + (sd > 0 ? " ± " + decimals(1.96 * sd / 1000, 3) : "");
}

std::string surfaces_table_html(const RecoveryResult& result) {
    std::string out =
        "<div class='scroll'><table><thead><tr><th rowspan='2'>Surface</th>"
        "<th colspan='2' class='group'>Dice</th><th colspan='2' class='group'>Mean "
        "distance, mm</th><th colspan='2' class='group'>95 % Hausdorff, mm</th>"
        "<th colspan='2' class='group'>Largest distance, mm</th>"
        "<th rowspan='2' class='num'>Resultant force, N</th></tr><tr>"
        "<th class='num from'>before</th><th class='num'>after</th>"
        "<th class='num from'>before</th><th class='num'>after</th>"
        "<th class='num from'>before</th><th class='num'>after</th>"
        "<th class='num from'>before</th><th class='num'>after</th></tr></thead>"
        "<tbody>";
    bool any_cut = false;
    for (const SurfaceResult& s : result.surfaces) {
        any_cut = any_cut || s.cut_by_image;
        out += fmt::format(
            "<tr><td>{}{}{}</td>{}{}{}{}<td class='num'>{}</td></tr>", swatch(result, s.region),
            escape_html(s.name), s.cut_by_image ? " <sup>*</sup>" : "",
            before_after_cells(s.dice_before, s.dice_after, 3),
            before_after_cells(s.mean_distance_mm_before, s.mean_distance_mm_after, 2),
            before_after_cells(s.hausdorff95_mm_before, s.hausdorff95_mm_after, 2),
            before_after_cells(s.max_distance_mm_before, s.max_distance_mm_after, 2),
            s.role == Role::driven ? force_cell(s) : "–");
    }
    out += "</tbody></table></div>";
    if (any_cut)
        out +=
            "<p class='caption'><sup>*</sup> Cut by the field of view; the cut face carries no "
            "data.</p>";
    if (const std::string landmarks = landmark_sentence(result); !landmarks.empty())
        out += "<p class='caption'>" + escape_html(landmarks) + "</p>";
    if (const std::string seen = seen_sentence(result); !seen.empty())
        out += "<p class='caption'>" + escape_html(seen) + "</p>";
    return out;
}

std::string correlation_table_html(const RecoveryResult& result) {
    if (result.correlation.size() < 2) return "";
    const auto names = unknown_names(result, result.correlation.size());
    std::string out = "<figure class='wide'><table class='narrow'><thead><tr><th></th>" +
                      number_headers(names) + "</tr></thead><tbody>";
    for (std::size_t i = 0; i < names.size(); ++i)
        out += "<tr><th>" + names[i] + "</th>" + number_cells(result.correlation[i]) + "</tr>";
    return out +
           "</tbody></table><figcaption>Correlation of ln E between the unknown moduli: near "
           "+1 or −1 the data fix only a combination of the two.</figcaption></figure>";
}

std::string sensitivity_table_html(const RecoveryResult& result) {
    if (result.sensitivity.empty()) return "";
    const auto names = unknown_names(result, result.sensitivity.size());
    std::string out =
        "<figure class='wide'><table class='narrow'><thead><tr>"
        "<th class='num'>Singular value</th><th class='num'>Prior narrowed to</th>" +
        number_headers(names) + "</tr></thead><tbody>";
    for (const SensitivityResult& s : result.sensitivity)
        out += fmt::format("<tr><td class='num'>{}</td><td class='num'>{} %</td>{}</tr>",
                           significant(s.singular_value),
                           significant(100 / std::hypot(1.0, s.singular_value)),
                           number_cells(s.direction));
    return out +
           "</tbody></table><figcaption>Scaled sensitivity: how many standard deviations of the "
           "noise the seen surfaces move when ln E changes by one standard deviation of its prior "
           "along a direction (components at the right), where no motion of the walls could "
           "explain it. Below about 1 the images say little.</figcaption></figure>";
}

std::string details_html(const RecoveryResult& result) {
    const MesherSummary& m = result.mesher;
    const ImageGrid& grid = result.reference_labels.grid;
    std::vector<std::pair<std::string, std::string>> facts = {
        {"Rigid alignment", alignment_text(result.alignment)},
        {"Tissue", law_sentence(result)},
        {"Search", termination_sentence(result)},
        {"Contours", contours_sentence(result)},
        {"Residual of the final solve", fmt::format("{:.1e}", result.full_model_residual)},
        {"Mesh", fmt::format("{} nodes, {} tetrahedra ({}), smallest dihedral angle {}°",
                             result.mesh.num_nodes(), result.mesh.num_elements(),
                             result.mesh.table().name, decimals(m.quality.min_dihedral_deg, 1))},
        {"Mesher", m.mesher + (m.fallback.empty() ? "" : "; " + m.fallback)},
        {"Grid", fmt::format("{} × {} × {} voxels of {} × {} × {} mm", grid.size[0], grid.size[1],
                             grid.size[2], significant(grid.spacing[0]),
                             significant(grid.spacing[1]), significant(grid.spacing[2]))},
        {"Computed by", device_text(result.device)},
        {"Linear solvers", linear_solvers_text(result)},
        {"Note", result.seed_note}};
    for (auto& row : titled_rows(recovery_tree(result))) facts.push_back(std::move(row));
    return "<div class='columns'><div>" + facts_html(facts) + "</div><div>" +
           timings_table(result) + "</div></div>";
}

}  // namespace palpate
