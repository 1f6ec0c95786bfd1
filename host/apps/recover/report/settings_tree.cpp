// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/settings_tree.hpp"

#include "host/page/tree_values.hpp"

namespace palpate {
namespace {

FigureValue known_or_unknown(const std::optional<double>& value) {
    return value ? FigureValue(*value) : FigureValue("unknown");
}

FigureValue ratio_or_unknown(bool is_unknown, double ratio) {
    return is_unknown ? FigureValue("unknown") : FigureValue(ratio);
}

ResultTree organ_part(const OrganSettings& o) {
    ResultTree part = ResultTree::of(
        o.name,
        {{"name", o.name}, {"label", o.label}, {"role", name_of(o.role)}, {"hollow", o.hollow}});
    if (o.hollow) return part;
    part.add("stiffness_kpa", known_or_unknown(o.stiffness_kpa));
    part.add("poisson_ratio", ratio_or_unknown(o.poisson_unknown, o.poisson_ratio));
    return part;
}

ResultTree background_part(const BackgroundSettings& b) {
    return ResultTree::of("background",
                          {{"label", value_or_null(b.label)},
                           {"stiffness_kpa", b.stiffness_kpa},
                           {"poisson_ratio", ratio_or_unknown(b.poisson_unknown, b.poisson_ratio)},
                           {"outer_boundary", b.outer_boundary_fixed ? "fixed" : "free"}});
}

}  // namespace

ResultTree settings_tree(const Settings& settings) {
    ResultTree tree{.name = "settings"};
    if (settings.background)
        tree.add(background_part(*settings.background));
    else
        tree.add("background", FigureValue());
    ResultTree& organs = tree.add_part("organ", ResultTree::Shape::list);
    for (const OrganSettings& organ : settings.organs) organs.add(organ_part(organ));
    const PriorSettings& p = settings.prior;
    tree.add(ResultTree::of("prior", {{"noise_voxels", p.noise_voxels},
                                      {"contour_sd_mm", known_or_unknown(p.contour_sd_mm)},
                                      {"contour_style", contour_style_name(p)},
                                      {"displacement_sd_mm", p.displacement_sd_mm},
                                      {"displacement_range_mm", p.displacement_range_mm},
                                      {"stiffness_median_ratio", p.stiffness_median_ratio},
                                      {"stiffness_sd_ln", p.stiffness_sd_ln},
                                      {"poisson_lowest", p.poisson_lowest},
                                      {"poisson_highest", p.poisson_highest}}));
    return tree;
}

}  // namespace palpate
