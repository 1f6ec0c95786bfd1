// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/recovery_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/apps/recover/report/findings.hpp"
#include "host/apps/recover/report/settings_tree.hpp"
#include "host/io/displacement_steps.hpp"
#include "host/page/solver_figures.hpp"
#include "host/page/tree_values.hpp"
#include "solver/materials/material.hpp"

namespace palpate {
namespace {

constexpr auto list_of_parts = ResultTree::Shape::list;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

Figure ratio_figure(const RegionResult& r) {
    Figure figure{.name = "searched_poisson_ratio", .title = "Poisson's ratio", .decimals = 2};
    if (!r.ratio) return figure;
    figure.value = r.poisson_ratio;
    figure.interval_95 = r.ratio->interval;
    figure.verdict = r.ratio->verdict;
    figure.reason = r.ratio->reason;
    return figure;
}

/// G = E / (2 (1 + nu)), which elastography measures; none where the images tell nothing of E.
Figure shear_figure(const RegionResult& r) {
    const bool has_modulus = !r.hollow && is_known(r);
    const auto shear = [&](double stiffness_kpa) {
        return has_modulus ? shear_modulus({stiffness_kpa, r.poisson_ratio}) : none;
    };
    return {.name = "shear_modulus_kpa",
            .value = shear(r.stiffness_kpa),
            .unit = "kPa",
            .title = "Shear modulus",
            .meaning = "what elastography measures",
            .interval_95 = std::array{shear(r.interval_kpa[0]), shear(r.interval_kpa[1])},
            .interval_name = "shear_modulus_interval_kpa"};
}

ResultTree region_part(const RegionResult& r) {
    const auto of_solid = [&](double value) { return r.hollow ? none : value; };
    const auto& [low, high] = r.interval_kpa;
    ResultTree part{.name = r.name};
    part.add(Figure{.name = "name", .value = r.name, .title = "Region"});
    part.add(Figure{.name = "label", .value = r.label, .title = "Label"});
    part.add(Figure{.name = "role", .value = name_of(r.role), .title = "Role"});
    part.add("hollow", r.hollow);
    part.add("unknown", r.unknown);
    part.add(Figure{.name = "stiffness_kpa",
                    .value = of_solid(r.stiffness_kpa),
                    .unit = "kPa",
                    .title = "Stiffness",
                    .meaning = "Young's modulus at rest",
                    .interval_95 = std::array{of_solid(low), of_solid(high)},
                    .verdict = r.verdict,
                    .reason = r.reason,
                    .interval_name = "interval_kpa"});
    part.add("most_probable_kpa", of_solid(r.most_probable_kpa));
    const auto of_end = [&](int end) -> FigureValue {
        if (!r.unknown || !std::isfinite(r.interval_kpa[end])) return {};
        return r.seen_ends[end] ? "images" : "prior";
    };
    part.add("lower_end_from", of_end(0));
    part.add("upper_end_from", of_end(1));
    part.add("other_answers_kpa", r.other_answers_kpa);
    part.add("contradicts_prior", r.contradicts_prior);
    part.add("sd_ln_stiffness", of_solid(r.sd_ln));
    part.add(shear_figure(r));
    part.add(Figure{.name = "poisson_ratio",
                    .value = of_solid(r.poisson_ratio),
                    .title = "Poisson's ratio",
                    .decimals = 2});
    part.add(ratio_figure(r));
    part.add("jacobian_range",
             std::vector{of_solid(r.jacobian_range[0]), of_solid(r.jacobian_range[1])});
    part.add("strain_energy_mj", of_solid(r.strain_energy_mj));
    return part;
}

ResultTree surface_part(const SurfaceResult& s) {
    return ResultTree::of(s.name, {{"name", s.name},
                                   {"role", name_of(s.role)},
                                   {"target", s.target_kind},
                                   {"seen_share", s.seen_share},
                                   {"dice_before", s.dice_before},
                                   {"dice_after", s.dice_after},
                                   {"mean_distance_mm_before", s.mean_distance_mm_before},
                                   {"mean_distance_mm_after", s.mean_distance_mm_after},
                                   {"max_distance_mm_before", s.max_distance_mm_before},
                                   {"max_distance_mm_after", s.max_distance_mm_after},
                                   {"hausdorff95_mm_before", s.hausdorff95_mm_before},
                                   {"hausdorff95_mm_after", s.hausdorff95_mm_after},
                                   {"cut_by_image", s.cut_by_image},
                                   {"resultant_force_mn", components(s.resultant_force_mn)},
                                   {"resultant_sd_mn", components(s.resultant_sd_mn)}});
}

ResultTree landmarks_part(const RecoveryResult& result) {
    ResultTree list{.name = "landmarks", .shape = list_of_parts};
    for (const LandmarkResult& l : result.landmarks)
        list.add(ResultTree::of("", {{"reference_mm", components(l.at.reference)},
                                     {"target_mm", components(l.at.target)},
                                     {"error_mm_before", l.error_mm_before},
                                     {"error_mm_after", l.error_mm_after},
                                     {"inside", l.is_inside}}));
    return list;
}

ResultTree mesh_part(const RecoveryResult& result) {
    const MeshQuality& q = result.mesher.quality;
    ResultTree part = ResultTree::of("mesh", {{"nodes", result.mesh.num_nodes()},
                                              {"elements", result.mesh.num_elements()},
                                              {"element_type", result.mesh.table().name},
                                              {"mesher", result.mesher.mesher},
                                              {"fallback", result.mesher.fallback},
                                              {"inverted", q.num_inverted},
                                              {"min_dihedral_deg", q.min_dihedral_deg},
                                              {"max_dihedral_deg", q.max_dihedral_deg},
                                              {"min_volume_mm3", q.min_volume_mm3}});
    if (result.mesh_change_mm)
        part.add(Figure{.name = "change_mm",
                        .value = *result.mesh_change_mm,
                        .unit = "mm",
                        .title = "Surfaces that elements of no size would move, on average by",
                        .decimals = 3});
    else
        part.add("change_mm", FigureValue());
    return part;
}

ResultTree grid_part(const ImageGrid& grid) {
    return ResultTree::of("grid",
                          {{"size", std::vector<std::int64_t>(grid.size.begin(), grid.size.end())},
                           {"spacing_mm", components(grid.spacing)},
                           {"origin_mm", components(grid.origin)},
                           {"direction", rows_of_matrix(grid.direction)}});
}

/// Which displacement field is which; null for files that are not written, and what describes them.
ResultTree fields_part(FieldChoice written) {
    const auto of_image = [&](FigureValue value) {
        return has_image(written) ? value : FigureValue();
    };
    const auto of_transform = [&](FigureValue value) {
        return has_transform(written) ? value : FigureValue();
    };
    ResultTree list{.name = "fields", .shape = list_of_parts};
    for (const FieldFile& f : {forward_field, backward_field})
        list.add(
            ResultTree::of("", {{"points_from", f.points_from},
                                {"points_to", f.points_to},
                                {"grid_of", f.points_from},
                                {"step_mm", of_image(displacement_step_mm)},
                                {"displacement_field", of_image(f.field)},
                                {"itk_transform", of_transform(f.transform)},
                                {"itk_transform_resamples",
                                 of_transform(fmt::format("images of the {} onto the {}'s grid",
                                                          f.points_to, f.points_from))}}));
    return list;
}

ResultTree alignment_part(const AlignmentResult& a) {
    return ResultTree::of("alignment",
                          {{"method", a.method},
                           {"rotation", rows_of_matrix(a.reference_to_target.rotation)},
                           {"translation_mm", components(a.reference_to_target.translation)},
                           {"mean_distance_mm", a.mean_distance_mm},
                           {"moved_by_search_mm", a.moved_mm},
                           {"turned_by_search_deg", a.turned_deg}});
}

std::vector<std::string> names_of_unknown(const RecoveryResult& result) {
    std::vector<std::string> names;
    for (const RegionResult& r : result.regions)
        if (r.unknown) names.push_back(r.name);
    return names;
}

ResultTree correlation_part(const RecoveryResult& result) {
    return ResultTree::of("correlation", {{"regions", names_of_unknown(result)},
                                          {"ln_stiffness", result.correlation}});
}

ResultTree sensitivity_part(const RecoveryResult& result) {
    ResultTree part = ResultTree::of("sensitivity", {{"regions", names_of_unknown(result)}});
    ResultTree& list = part.add_part("combinations", list_of_parts);
    for (const SensitivityResult& s : result.sensitivity)
        list.add(ResultTree::of("", {{"scaled_singular_value", s.singular_value},
                                     {"direction_ln_stiffness", s.direction}}));
    return part;
}

ResultTree profiles_part(const RecoveryResult& result) {
    ResultTree list{.name = "profiles", .shape = list_of_parts};
    for (const ProfileResult& p : result.profiles) {
        const std::string name = region_name(result, p.region);
        list.add(ResultTree::of(
            name,
            {{"name", name}, {"stiffness_kpa", p.stiffness_kpa}, {"objective", p.objective}}));
    }
    return list;
}

ResultTree convergence_part(const RecoveryResult& result) {
    ResultTree list{.name = "convergence", .shape = list_of_parts};
    for (const IterationRecord& i : result.convergence)
        list.add(ResultTree::of("", {{"iteration", i.iteration},
                                     {"objective", i.objective},
                                     {"gradient_norm", i.gradient_norm},
                                     {"step", i.step},
                                     {"stiffness_kpa", i.stiffness_kpa}}));
    return list;
}

/// Stages that ran twice are added up.
ResultTree timings_part(const RecoveryResult& result) {
    std::vector<std::pair<std::string, double>> sums;
    for (const auto& [stage, seconds] : result.timings_s) {
        const auto at = std::find_if(sums.begin(), sums.end(), [&name = stage](const auto& sum) {
            return sum.first == name;
        });
        double& sum = at == sums.end() ? sums.emplace_back(stage, 0.0).second : at->second;
        if (std::isfinite(seconds)) sum += seconds;
    }
    ResultTree part{.name = "timings_s"};
    for (const auto& [stage, seconds] : sums) part.add(stage, seconds);
    part.add("total", total_seconds(result));
    return part;
}

ResultTree device_part(const BackendInfo& d) {
    return ResultTree::of("device",
                          {{"backend", d.backend},
                           {"platform", d.platform},
                           {"name", d.device},
                           {"version", d.version},
                           {"precision", d.precision == Precision::single ? "single" : "double"},
                           {"product", name_of(d.product)},
                           {"compute_units", d.compute_units}});
}

ResultTree linear_solvers_part(const RecoveryResult& result) {
    ResultTree stages{.name = "linear_solver"};
    for (const auto& [stage, solver] : result.linear_solvers)
        stages.add(solver_part(stage, solver));
    return stages;
}

void add_contours(const std::optional<ContourError>& contours, ResultTree& tree) {
    if (contours)
        tree.add(ResultTree::of("contours", {{"sd_mm", contours->sd_mm},
                                             {"length_mm", contours->length_mm},
                                             {"given", contours->is_given},
                                             {"slice_share", contours->slice_share},
                                             {"point_scale", contours->point_scale}}));
    else
        tree.add("contours", FigureValue());
}

}  // namespace

ResultTree regions_tree(const std::vector<RegionResult>& regions) {
    ResultTree list{.name = "regions", .shape = list_of_parts};
    for (const RegionResult& r : regions) list.add(region_part(r));
    return list;
}

ResultTree surfaces_tree(const RecoveryResult& result) {
    ResultTree list{.name = "surfaces", .shape = list_of_parts};
    for (const SurfaceResult& s : result.surfaces) list.add(surface_part(s));
    return list;
}

ResultTree recovery_tree(const RecoveryResult& result, bool include_file_names,
                         FieldChoice fields) {
    ResultTree tree = ResultTree::of("result", {{"format", "palpate-result"},
                                                {"format_version", 1},
                                                {"version", result.version},
                                                {"summary", summary_sentences(result)},
                                                {"frame", "LPS, mm"}});
    if (include_file_names)
        tree.add(ResultTree::of(
            "inputs", {{"reference", result.reference_name}, {"target", result.target_name}}));
    tree.add(grid_part(result.reference_labels.grid));
    tree.add(fields_part(fields));
    tree.add(regions_tree(result.regions));
    tree.add(correlation_part(result));
    tree.add(sensitivity_part(result));
    tree.add(surfaces_tree(result));
    add_contours(result.contours, tree);
    tree.add(landmarks_part(result));
    tree.add(profiles_part(result));
    tree.add(mesh_part(result));
    tree.add(alignment_part(result.alignment));
    tree.add(ResultTree::of("termination", {{"converged", result.termination.converged},
                                            {"reason", result.termination.reason},
                                            {"iterations", result.termination.iterations}}));
    tree.add(convergence_part(result));
    tree.add("full_model_residual", result.full_model_residual);
    tree.add(timings_part(result));
    tree.add(device_part(result.device));
    tree.add(linear_solvers_part(result));
    add_loops("element_loops", result.element_loops, tree);
    tree.add("material", result.law.name);
    tree.add(settings_tree(result.settings));
    if (!result.seed_note.empty()) tree.add("seed_note", result.seed_note);
    tree.add("warnings", result.warnings);
    return tree;
}

}  // namespace palpate
