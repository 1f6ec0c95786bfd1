// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/json_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/apps/recover/report/findings.hpp"
#include "host/io/displacement_steps.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json numbers(const std::vector<double>& values) {
    Json list = Json::array();
    for (double v : values) list.push_back(number(v));
    return list;
}

Json vector3(const Vec3& v) { return Json{number(v.x()), number(v.y()), number(v.z())}; }

Json searched_ratio_json(const RegionResult& r) {
    if (!r.ratio) return nullptr;
    return {{"interval", {number(r.ratio->interval[0]), number(r.ratio->interval[1])}},
            {"verdict", r.ratio->verdict},
            {"reason", r.ratio->reason}};
}

Json region_json(const RegionResult& r) {
    const auto of_solid = [&](double value) { return r.hollow ? Json(nullptr) : number(value); };
    return {{"name", r.name},
            {"label", r.label},
            {"role", r.role},
            {"hollow", r.hollow},
            {"unknown", r.unknown},
            {"stiffness_kpa", of_solid(r.stiffness_kpa)},
            {"interval_kpa", {of_solid(r.interval_kpa[0]), of_solid(r.interval_kpa[1])}},
            {"sd_ln_stiffness", of_solid(r.sd_ln)},
            {"poisson_ratio", of_solid(r.poisson_ratio)},
            {"searched_poisson_ratio", searched_ratio_json(r)},
            {"verdict", r.verdict},
            {"reason", r.reason},
            {"jacobian_range", {of_solid(r.jacobian_range[0]), of_solid(r.jacobian_range[1])}},
            {"strain_energy_mj", of_solid(r.strain_energy_mj)}};
}

Json surface_json(const SurfaceResult& s) {
    return {{"name", s.name},
            {"role", s.role},
            {"target", s.target_kind},
            {"seen_share", number(s.seen_share)},
            {"dice_before", number(s.dice_before)},
            {"dice_after", number(s.dice_after)},
            {"mean_distance_mm_before", number(s.mean_distance_mm_before)},
            {"mean_distance_mm_after", number(s.mean_distance_mm_after)},
            {"max_distance_mm_before", number(s.max_distance_mm_before)},
            {"max_distance_mm_after", number(s.max_distance_mm_after)},
            {"hausdorff95_mm_before", number(s.hausdorff95_mm_before)},
            {"hausdorff95_mm_after", number(s.hausdorff95_mm_after)},
            {"cut_by_image", s.cut_by_image},
            {"resultant_force_mn", vector3(s.resultant_force_mn)},
            {"resultant_sd_mn", vector3(s.resultant_sd_mn)}};
}

Json landmarks_json(const RecoveryResult& result) {
    Json list = Json::array();
    for (const LandmarkResult& l : result.landmarks)
        list.push_back({{"reference_mm", vector3(l.at.reference)},
                        {"target_mm", vector3(l.at.target)},
                        {"error_mm_before", number(l.error_mm_before)},
                        {"error_mm_after", number(l.error_mm_after)},
                        {"inside", l.is_inside}});
    return list;
}

Json mesh_json(const RecoveryResult& result) {
    const MeshQuality& q = result.mesher.quality;
    return {{"nodes", result.mesh.mesh.num_nodes()},
            {"elements", result.mesh.mesh.num_tets()},
            {"element_type", "tet4"},
            {"mesher", result.mesher.mesher},
            {"fallback", result.mesher.fallback},
            {"inverted", q.num_inverted},
            {"min_dihedral_deg", number(q.min_dihedral_deg)},
            {"max_dihedral_deg", number(q.max_dihedral_deg)},
            {"min_volume_mm3", number(q.min_volume_mm3)}};
}

Json grid_json(const ImageGrid& grid) {
    Json direction = Json::array();
    for (int row = 0; row < 3; ++row) direction.push_back(vector3(grid.direction.row(row)));
    return {{"size", grid.size},
            {"spacing_mm", vector3(grid.spacing)},
            {"origin_mm", vector3(grid.origin)},
            {"direction", direction}};
}

/// Which displacement field is which; null for files that are not written, and what describes them.
Json fields_json(FieldChoice written) {
    const auto of_image = [&](Json value) { return has_image(written) ? value : Json(nullptr); };
    const auto of_transform = [&](Json value) {
        return has_transform(written) ? value : Json(nullptr);
    };
    Json list = Json::array();
    for (const FieldFile& f : {forward_field, backward_field})
        list.push_back({{"points_from", f.points_from},
                        {"points_to", f.points_to},
                        {"grid_of", f.points_from},
                        {"step_mm", of_image(displacement_step_mm)},
                        {"displacement_field", of_image(f.field)},
                        {"itk_transform", of_transform(f.transform)},
                        {"itk_transform_resamples",
                         of_transform(fmt::format("images of the {} onto the {}'s grid",
                                                  f.points_to, f.points_from))}});
    return list;
}

Json alignment_json(const AlignmentResult& a) {
    Json rotation = Json::array();
    for (int row = 0; row < 3; ++row)
        rotation.push_back(vector3(a.reference_to_target.rotation.row(row)));
    return {{"method", a.method},
            {"rotation", rotation},
            {"translation_mm", vector3(a.reference_to_target.translation)},
            {"mean_distance_mm", number(a.mean_distance_mm)},
            {"moved_by_search_mm", number(a.moved_mm)},
            {"turned_by_search_deg", number(a.turned_deg)}};
}

Json correlation_json(const RecoveryResult& result) {
    Json names = Json::array(), rows = Json::array();
    for (const RegionResult& r : result.regions)
        if (r.unknown) names.push_back(r.name);
    for (const auto& row : result.correlation) rows.push_back(numbers(row));
    return {{"regions", names}, {"ln_stiffness", rows}};
}

Json sensitivity_json(const RecoveryResult& result) {
    Json names = Json::array(), list = Json::array();
    for (const RegionResult& r : result.regions)
        if (r.unknown) names.push_back(r.name);
    for (const SensitivityResult& s : result.sensitivity)
        list.push_back({{"scaled_singular_value", number(s.singular_value)},
                        {"direction_ln_stiffness", numbers(s.direction)}});
    return {{"regions", names}, {"combinations", list}};
}

Json profiles_json(const RecoveryResult& result) {
    Json list = Json::array();
    for (const ProfileResult& p : result.profiles)
        list.push_back({{"name", region_name(result, p.region)},
                        {"stiffness_kpa", numbers(p.stiffness_kpa)},
                        {"objective", numbers(p.objective)}});
    return list;
}

Json convergence_json(const RecoveryResult& result) {
    Json list = Json::array();
    for (const IterationRecord& i : result.convergence)
        list.push_back({{"iteration", i.iteration},
                        {"objective", number(i.objective)},
                        {"gradient_norm", number(i.gradient_norm)},
                        {"step", number(i.step)},
                        {"stiffness_kpa", numbers(i.stiffness_kpa)}});
    return list;
}

Json timings_json(const RecoveryResult& result) {
    Json timings = Json::object();
    for (const auto& [stage, seconds] : result.timings_s) {
        const double before = timings.contains(stage) ? timings[stage].get<double>() : 0.0;
        timings[stage] = before + (std::isfinite(seconds) ? seconds : 0.0);
    }
    timings["total"] = number(total_seconds(result));
    return timings;
}

Json device_json(const BackendInfo& d) {
    return {{"backend", d.backend},
            {"platform", d.platform},
            {"name", d.device},
            {"version", d.version},
            {"precision", d.precision == Precision::single ? "single" : "double"},
            {"product", name_of(d.product)},
            {"compute_units", d.compute_units}};
}

Json linear_solvers_json(const RecoveryResult& result) {
    Json stages = Json::object();
    for (const auto& [stage, solver] : result.linear_solvers)
        stages[stage] = {{"method", name_of(solver.method)},
                         {"library", solver.library},
                         {"backend", solver.device.backend},
                         {"device", solver.device.device},
                         {"reason", solver.reason}};
    return stages;
}

Json contours_json(const std::optional<ContourError>& contours) {
    if (!contours) return nullptr;
    return {{"sd_mm", number(contours->sd_mm)},
            {"length_mm", number(contours->length_mm)},
            {"given", contours->is_given},
            {"point_scale", number(contours->point_scale)}};
}

Json organ_json(const OrganSettings& o) {
    Json json{
        {"name", o.name}, {"label", o.label}, {"role", name_of(o.role)}, {"hollow", o.hollow}};
    if (o.hollow) return json;
    json["stiffness_kpa"] = o.stiffness_kpa ? number(*o.stiffness_kpa) : Json("unknown");
    json["poisson_ratio"] = o.poisson_unknown ? Json("unknown") : number(o.poisson_ratio);
    return json;
}

Json background_json(const BackgroundSettings& b) {
    return {{"label", b.label ? Json(*b.label) : Json(nullptr)},
            {"stiffness_kpa", number(b.stiffness_kpa)},
            {"poisson_ratio", b.poisson_unknown ? Json("unknown") : number(b.poisson_ratio)},
            {"outer_boundary", b.outer_boundary_fixed ? "fixed" : "free"}};
}

/// The values that were used; the text of the file stays out because comments may name a patient.
Json settings_json(const Settings& s) {
    Json organs = Json::array();
    for (const OrganSettings& organ : s.organs) organs.push_back(organ_json(organ));
    const PriorSettings& p = s.prior;
    return {{"background", s.background ? background_json(*s.background) : Json(nullptr)},
            {"organ", organs},
            {"prior",
             {{"noise_voxels", number(p.noise_voxels)},
              {"contour_sd_mm", p.contour_sd_mm ? number(*p.contour_sd_mm) : Json("unknown")},
              {"displacement_sd_mm", number(p.displacement_sd_mm)},
              {"displacement_range_mm", number(p.displacement_range_mm)},
              {"stiffness_median_ratio", number(p.stiffness_median_ratio)},
              {"stiffness_sd_ln", number(p.stiffness_sd_ln)},
              {"poisson_lowest", number(p.poisson_lowest)},
              {"poisson_highest", number(p.poisson_highest)}}}};
}

}  // namespace

std::string json_report(const RecoveryResult& result, bool include_file_names, FieldChoice fields) {
    Json json{{"format", "palpate-result"}, {"format_version", 1}, {"version", result.version}};
    json["summary"] = summary_sentences(result);
    json["frame"] = "LPS, mm";
    if (include_file_names)
        json["inputs"] = {{"reference", result.reference_name}, {"target", result.target_name}};
    json["grid"] = grid_json(result.reference_labels.grid);
    json["fields"] = fields_json(fields);
    Json regions = Json::array(), surfaces = Json::array();
    for (const RegionResult& r : result.regions) regions.push_back(region_json(r));
    for (const SurfaceResult& s : result.surfaces) surfaces.push_back(surface_json(s));
    json["regions"] = regions;
    json["correlation"] = correlation_json(result);
    json["sensitivity"] = sensitivity_json(result);
    json["surfaces"] = surfaces;
    json["contours"] = contours_json(result.contours);
    json["landmarks"] = landmarks_json(result);
    json["profiles"] = profiles_json(result);
    json["mesh"] = mesh_json(result);
    json["alignment"] = alignment_json(result.alignment);
    json["termination"] = {{"converged", result.termination.converged},
                           {"reason", result.termination.reason},
                           {"iterations", result.termination.iterations}};
    json["convergence"] = convergence_json(result);
    json["full_model_residual"] = number(result.full_model_residual);
    json["timings_s"] = timings_json(result);
    json["device"] = device_json(result.device);
    json["linear_solver"] = linear_solvers_json(result);
    json["material"] = name_of(result.law);
    json["settings"] = settings_json(result.settings);
    if (!result.seed_note.empty()) json["seed_note"] = result.seed_note;
    json["warnings"] = result.warnings;
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace palpate
