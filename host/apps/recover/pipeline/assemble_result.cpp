// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/assemble_result.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "host/apps/recover/inverse/identifiability.hpp"
#include "host/apps/recover/inverse/model_error.hpp"
#include "host/apps/recover/modelling/regions.hpp"
#include "host/apps/recover/pipeline/deformation.hpp"
#include "host/apps/recover/pipeline/judged_modulus.hpp"
#include "host/apps/recover/pipeline/observed_target.hpp"
#include "host/apps/recover/pipeline/surface_agreement.hpp"
#include "host/apps/recover/pipeline/volumes.hpp"
#include "host/geometry/meshing/rasterise.hpp"
#include "host/geometry/surfaces/picture_surface.hpp"
#include "host/geometry/surfaces/surface.hpp"
#include "host/geometry/warping/inverse_field.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"
#include "solver/model/quadratic_mesh.hpp"

namespace palpate {
namespace {

constexpr double picture_edge_mm = 2.5;
/// Of a voxel: where the mesh's vertices lie further than this off the contours on average,
/// phantoms came out up to two fifths too soft (1,500 and 2,500 nodes; not with 4,000 and more).
constexpr double coarse_share_of_voxel = 0.15;
constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

std::vector<Vec3> as_points(const Eigen::VectorXd& values) {
    std::vector<Vec3> points(values.size() / 3);
    for (std::size_t k = 0; k < points.size(); ++k) points[k] = values.segment<3>(3 * k);
    return points;
}

std::vector<Held> held_nodes(const RecoveryModel& recovery) {
    std::vector<Held> held(recovery.model.mesh.nodes.size(), Held::free);
    for (const Index node : recovery.fixed) held[node] = Held::fixed;
    for (const Index node : recovery.driven) held[node] = Held::driven;
    return held;
}

RegionResult background_result(const Settings& settings) {
    RegionResult result;
    result.region = background_region;
    result.name = "background";
    result.label = label_of_region(settings, background_region);
    result.role = Role::background;
    result.poisson_ratio = settings.background->poisson_ratio;
    result.stiffness_kpa = settings.background->stiffness_kpa;
    result.most_probable_kpa = result.stiffness_kpa;
    result.interval_kpa = {result.stiffness_kpa, result.stiffness_kpa};
    result.verdict = Verdict::given;
    result.reason = "reference tissue: every modulus is relative to it";
    return result;
}

std::vector<std::vector<double>> correlation_of(const Eigen::MatrixXd& covariance) {
    std::vector<std::vector<double>> rows(covariance.rows());
    for (Index a = 0; a < covariance.rows(); ++a) {
        for (Index b = 0; b < covariance.cols(); ++b) {
            rows[a].push_back(covariance(a, b) / std::sqrt(covariance(a, a) * covariance(b, b)));
        }
    }
    return rows;
}

std::vector<SensitivityResult> sensitivity_of(const ScaledSensitivity& sensitivity) {
    std::vector<SensitivityResult> results;
    for (Index k = 0; k < sensitivity.singular_values.size(); ++k) {
        const auto direction = sensitivity.directions.col(k);
        results.push_back({sensitivity.singular_values[k], {direction.begin(), direction.end()}});
    }
    return results;
}

void describe_unknown(const Recovered& found, const Settings& settings, RegionResult& result) {
    const auto& estimate = found.estimate;
    result.unknown = true;
    result.stiffness_kpa = stiffness_kpa(found.recovery.model, result.region);
    result.most_probable_kpa = result.stiffness_kpa;
    const Judgement verdict = judge_unobserved(result.role == Role::driven);
    result.verdict = verdict.verdict;
    result.reason = verdict.reason;
    result.sd_ln = settings.prior.stiffness_sd_ln;
    result.interval_kpa = prior_interval(result.stiffness_kpa, result.sd_ln);
    for (std::size_t k = 0; k < estimate.unknown.size(); ++k) {
        if (estimate.unknown[k].object != result.region) continue;
        judge_modulus(estimate, k, settings, result);
    }
    if (has_known_tissue(settings)) return;
    const Judgement without = judge_without_reference();
    result.verdict = without.verdict;
    result.reason = without.reason;
    result.contradicts_prior = false;
}

/// Everything that was allowed, for a region whose ratio moves nothing that is seen.
RatioResult unseen_ratio(const PriorSettings& prior) {
    return {{prior.poisson_lowest, prior.poisson_highest},
            Verdict::not_identifiable,
            "the ratio has no influence on the surfaces that were seen"};
}

void describe_ratio(const Recovered& found, const Settings& settings, RegionResult& result) {
    const auto& unknown = found.recovery.unknown_ratio;
    if (std::find(unknown.begin(), unknown.end(), result.region) == unknown.end()) return;
    result.poisson_ratio = poisson_ratio(found.recovery.model, result.region);
    result.ratio = unseen_ratio(settings.prior);
    const auto& regions = found.poisson->regions;
    const auto place = std::find(regions.begin(), regions.end(), result.region);
    if (place == regions.end()) return;
    const auto k = place - regions.begin();
    const RatioPosterior& ratios = found.poisson->ratios;
    const RatioEvidence evidence{result.poisson_ratio, with_ratio_model_error(ratios.reach[k]),
                                 ratios.at_limit[k], result.ratio->interval};
    const Judgement verdict = judge_ratio(evidence);
    if (verdict.verdict == Verdict::not_identifiable) {
        result.ratio->reason = verdict.reason;
    } else {
        result.ratio = {evidence.interval(), verdict.verdict, verdict.reason};
    }
}

std::vector<RegionResult> region_results(const Recovered& found, const Settings& settings) {
    std::vector<RegionResult> results;
    if (settings.background) {
        results.push_back(background_result(settings));
        describe_ratio(found, settings, results.back());
    }
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        const auto& organ = settings.organs[k];
        RegionResult result;
        result.region = first_organ_region + static_cast<Index>(k);
        result.name = organ.name;
        result.label = organ.label;
        result.role = organ.role;
        result.hollow = organ.hollow;
        result.poisson_ratio = organ.poisson_ratio;
        if (organ.hollow) {
            result.verdict = Verdict::hollow;
            result.reason = "its inside is not modelled";
        } else if (organ.stiffness_kpa) {
            result.stiffness_kpa = *organ.stiffness_kpa;
            result.most_probable_kpa = result.stiffness_kpa;
            result.interval_kpa = {*organ.stiffness_kpa, *organ.stiffness_kpa};
            result.verdict = Verdict::given;
            result.reason = "set in the settings";
        } else {
            describe_unknown(found, settings, result);
        }
        describe_ratio(found, settings, result);
        results.push_back(std::move(result));
    }
    return results;
}

void add_deformations(const Recovered& found, std::vector<RegionResult>& regions) {
    const auto deformations =
        region_deformations(found.recovery.model, found.law, found.displacement);
    for (RegionResult& region : regions) {
        if (region.hollow) continue;
        region.jacobian_range = deformations[region.region].jacobian_range;
        region.strain_energy_mj = deformations[region.region].strain_energy_mj;
    }
}

/// Corners of the box of the target's voxels of a region, where the alignment lays it, mm. None for
/// a region without voxels.
std::vector<Vec3> box_of_region(const LabelledState& target, const AlignmentResult& alignment,
                                Index region) {
    const ImageGrid& grid = target.regions.grid;
    Vec3 low = Vec3::Constant(HUGE_VAL), high = -low;
    for (Index k = 0; k < grid.size[2]; ++k)
        for (Index j = 0; j < grid.size[1]; ++j)
            for (Index i = 0; i < grid.size[0]; ++i)
                if (target.regions.at(i, j, k) == region) {
                    low = low.cwiseMin(Vec3(i, j, k));
                    high = high.cwiseMax(Vec3(i, j, k));
                }
    std::vector<Vec3> corners;
    const RigidTransform back = alignment.reference_to_target.inverse();
    for (int corner = 0; corner < 8 && low.x() <= high.x(); ++corner) {
        const Vec3 index((corner & 1 ? high : low).x(), (corner & 2 ? high : low).y(),
                         (corner & 4 ? high : low).z());
        corners.push_back(back.apply(grid.to_point(index)));
    }
    return corners;
}

/// What the search took the contours to be off in one image; of a target without labels all of it
/// is the reference's.
std::optional<ContourError> contour_error(const MapEstimate& estimate, const TargetState& target,
                                          const Settings& settings) {
    if (!estimate.posterior) return std::nullopt;
    const bool is_given = settings.prior.contour_sd_mm.has_value();
    if (!is_given && estimate.posterior->num_observed_rows() == 0) return std::nullopt;
    const NoiseLevel& noise = estimate.noise_level;
    return ContourError{noise.contour_mm / contour_images(target),
                        contour_length_mm,
                        is_given,
                        target.labels ? 2 : 1,
                        noise.scale,
                        !is_given && noise.contour_mm >= most_contour_mm,
                        noise.slice_share};
}

/// What a reader must know where contours and surfaces do not go together.
std::vector<std::string> warnings_about(const std::optional<ContourError>& contours) {
    constexpr double much = 3;  // times what voxels leave
    if (!contours) return {};
    if (contours->is_most)
        return {fmt::format(
            "The surfaces fit as badly as if contours were off by {:.2g} mm, the most that is "
            "looked for: a label may mean something else in one of the images, or the alignment "
            "be wrong. Look at the distances that are left; the intervals may be too narrow.",
            contours->sd_mm)};
    if (contours->is_given && contours->point_scale > much)
        return {
            fmt::format("The surfaces do not fit with contour_sd_mm = {:.2g}: each point is "
                        "off by itself {:.1f} times as far as voxels explain. Contours may be "
                        "further off than given.",
                        contours->sd_mm, contours->point_scale)};
    return {};
}

SurfaceResult surface_result(const Recovered& found, std::size_t s, const TargetState& target,
                             const Settings& settings) {
    const ObservedSurface& observed = found.recovery.surfaces[s];
    SurfaceResult result;
    result.region = observed.region;
    result.name = name_of_region(settings, observed.region);
    result.role = observed.driven ? Role::driven : Role::tissue;
    result.cut_by_image = observed.cut_by_image;
    result.reference = observed.surface;
    result.node_of = observed.node_of;
    if (s < found.resultant_sd.size()) result.resultant_sd_mn = found.resultant_sd[s];
    for (const Index node : observed.node_of) {
        if (observed.driven) result.resultant_force_mn += found.force.segment<3>(3 * node);
    }
    if (target.labels) {
        std::vector<Vec3> near = observed.surface.vertices;
        for (const Vec3& corner : box_of_region(*target.labels, target.alignment, observed.region))
            near.push_back(corner);
        result.target =
            picture_surface(*found.target[s], near, picture_edge_mm,
                            [&](const Vec3& point) { return in_field_of_view(target, point); });
    } else {
        result.target_kind = target.shown[s].kind;
        result.target = target.shown[s].picture;
    }
    measure_agreement(found, s, target, result);
    return result;
}

/// The target's grid; where there is none, the reference's, moved with the patient.
ImageGrid target_grid(const LabelledState& reference, const TargetState& target) {
    if (target.labels) return target.labels->regions.grid;
    const RigidTransform& transform = target.alignment.reference_to_target;
    ImageGrid grid = reference.regions.grid;
    grid.origin = transform.apply(grid.origin);
    grid.direction = transform.rotation * grid.direction;
    return grid;
}

void add_volumes(const Recovered& found, const LabelledState& reference, const TargetState& target,
                 const Settings& settings, RecoveryResult& result) {
    const RigidTransform& transform = found.alignment.reference_to_target;
    const ImageGrid grid = target_grid(reference, target);
    const Mesh mesh = linear_mesh_of(result.mesh);
    const auto field = displacement_on_grid(mesh, result.displacement, reference.regions.grid);
    InverseField inverse = inverse_field(mesh, result.displacement, field, transform, grid);
    result.inverse_displacement_field = std::move(inverse.field);
    if (inverse.num_unsure > 0)
        result.warnings.push_back(
            fmt::format("The inverse displacement field is off by more than 0.01 mm in {} of {} "
                        "voxels, all outside the mesh, where the field folds.",
                        inverse.num_unsure, grid.num_voxels()));
    const auto before = carry_regions(reference.field, transform, grid);
    const auto after = carry_regions(reference.field, result.inverse_displacement_field);
    const RegionImage* seen = target.labels ? &target.labels->regions : nullptr;
    for (auto& surface : result.surfaces) {
        surface.dice_before = seen ? dice(before, *seen, surface.region) : not_known;
        surface.dice_after = seen ? dice(after, *seen, surface.region) : not_known;
    }
    result.displacement_field = with_alignment(field, transform);
    result.reference_labels = to_labels(before, settings);
    if (seen) result.target_labels_aligned = to_labels(*seen, settings);
    result.warped_labels = to_labels(after, settings);
}

/// What a reader must know about organs without data.
std::vector<std::string> warnings_about(const std::vector<SurfaceResult>& surfaces) {
    std::vector<std::string> warnings;
    for (const auto& surface : surfaces) {
        if (surface.target_kind == "none") {
            warnings.push_back(fmt::format(
                "No target was given for {} ({}): it carries no data and moves as {}.",
                surface.name, name_of(surface.role),
                surface.role == Role::driven ? "its prior and the other organs' surfaces let it"
                                             : "its surroundings do"));
        } else if (surface.seen_share == 0) {
            warnings.push_back(
                fmt::format("The target of {} shows no part of its surface: it carries no data.",
                            surface.name));
        }
    }
    return warnings;
}

/// Of the vertices of an organ's surface from its contours in the reference, mm, by area.
double mean_offset_mm(const ObservedSurface& observed, const LabelField& contours) {
    const auto areas = vertex_areas(observed.surface);
    double sum = 0, area = 0;
    for (std::size_t v = 0; v < areas.size(); ++v) {
        sum += areas[v] * std::abs(contours.value(observed.region, observed.surface.vertices[v]));
        area += areas[v];
    }
    return area > 0 ? sum / area : 0;
}

/// Empty where the elements follow the contours.
std::vector<std::string> warnings_about_elements(const RecoveryModel& recovery,
                                                 const LabelField& contours,
                                                 const Settings& settings) {
    double worst_mm = coarse_share_of_voxel * std::cbrt(contours.grid().voxel_volume());
    std::vector<std::string> warnings;
    for (const ObservedSurface& observed : recovery.surfaces) {
        const double offset_mm = mean_offset_mm(observed, contours);
        if (offset_mm <= worst_mm) continue;
        worst_mm = offset_mm;
        warnings = {fmt::format(
            "The mesh is coarse for these contours: its surface of {} lies {:.2f} mm off them on "
            "average. On phantoms with such meshes stiffnesses came out up to two fifths too soft, "
            "and intervals missed; take more nodes.",
            name_of_region(settings, observed.region), offset_mm)};
    }
    return warnings;
}

}  // namespace

void add_motion(const Recovered& found, const LabelledState& reference, const TargetState& target,
                const Settings& settings, RecoveryResult& result) {
    result.mesh = found.recovery.model.mesh;
    result.displacement = as_points(found.displacement);
    if (found.mesh_change.size() > 0)
        result.mesh_change_mm =
            found.mesh_change.norm() / std::sqrt(static_cast<double>(found.mesh_change.size()) / 3);
    result.force = as_points(found.force);
    result.held = held_nodes(found.recovery);
    for (std::size_t s = 0; s < found.recovery.surfaces.size(); ++s) {
        result.surfaces.push_back(surface_result(found, s, target, settings));
    }
    add_volumes(found, reference, target, settings, result);
}

void add_element_stiffness(RecoveryResult& result) {
    std::map<Index, double> kpa;
    for (const RegionResult& region : result.regions) kpa[region.region] = region.most_probable_kpa;
    for (const Index region : result.mesh.region) {
        const auto own = kpa.find(region);
        if (own == kpa.end())
            throw Error(ErrorCode::internal,
                        fmt::format("the mesh has elements of region {}, of which the result says "
                                    "nothing; please report this",
                                    region));
        result.element_stiffness_kpa.push_back(own->second);
    }
}

RecoveryResult assemble_result(const Recovered& found, const LabelledState& reference,
                               const TargetState& target, const Settings& settings) {
    RecoveryResult result;
    result.settings = settings;
    result.settings_toml = to_toml(settings);
    result.version = version_text();
    result.law = found.law;
    result.mesher = found.mesher;
    add_motion(found, reference, target, settings, result);
    result.regions = region_results(found, settings);
    add_element_stiffness(result);
    add_deformations(found, result.regions);
    result.contours = contour_error(found.estimate, target, settings);
    result.correlation = correlation_of(found.estimate.covariance);
    result.sensitivity = sensitivity_of(found.estimate.sensitivity);
    result.profiles = found.estimate.profiles;
    result.convergence = found.estimate.records;
    result.alignment = found.alignment;
    result.termination = found.estimate.termination;
    result.device = found.solver.device;
    result.full_model_residual = found.relative_residual;
    const std::vector<std::string> of_volumes = std::exchange(result.warnings, found.warnings);
    for (auto& warning : warnings_about(result.surfaces))
        result.warnings.push_back(std::move(warning));
    for (auto& warning : warnings_about_elements(found.recovery, reference.field, settings))
        result.warnings.push_back(std::move(warning));
    for (auto& warning : warnings_about(result.contours))
        result.warnings.push_back(std::move(warning));
    if (settings.prior.contour_sd_mm && !found.estimate.posterior)
        result.warnings.push_back("contour_sd_mm has no effect on --method nested-lbfgs.");
    result.warnings.insert(result.warnings.end(), of_volumes.begin(), of_volumes.end());
    return result;
}

}  // namespace palpate
