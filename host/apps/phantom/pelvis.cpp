// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/pelvis.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <sstream>
#include <tuple>

#include "host/apps/phantom/anatomy.hpp"
#include "host/apps/phantom/curved_mesh.hpp"
#include "host/apps/phantom/deform.hpp"
#include "host/apps/phantom/tumour.hpp"
#include "host/apps/phantom/voxelise.hpp"
#include "host/apps/phantom/zones.hpp"
#include "host/geometry/surfaces/extract.hpp"
#include "solver/base/error.hpp"
#include "solver/model/quadratic_mesh.hpp"

namespace palpate {
namespace {

constexpr Index prostate_region = first_organ_region + prostate;
constexpr Index transition_zone_region = first_organ_region + num_pelvis_organs;
const std::vector<Index> hollow_regions{first_organ_region + bladder, first_organ_region + rectum,
                                        first_organ_region + bone_left,
                                        first_organ_region + bone_right};

void check_range(const char* name, double value, double low, double high) {
    if (value >= low && value <= high) return;
    std::ostringstream text;
    text << "The phantom's " << name << " is " << value << ", but must lie in " << low << " to "
         << high << ".";
    throw Error(ErrorCode::invalid_argument, text.str());
}

void check_options(const PelvisOptions& options) {
    check_range("stiffness_kpa", options.stiffness_kpa, 1, 10000);
    check_range("background_stiffness_kpa", options.background_stiffness_kpa, 0.1, 10000);
    check_range("poisson_ratio", options.poisson_ratio, 0, 0.495);
    check_range("background_poisson_ratio", options.background_poisson_ratio, 0, 0.495);
    check_range("num_nodes", options.num_nodes, 1000, 2000000);
    check_range("tangential_factor", options.tangential_factor, 0, 10);
    check_range("tumour_fraction", options.tumour_fraction, 0, 0.95);
    check_range("tumour_stiffness_kpa", options.tumour_stiffness_kpa, 1, 10000);
    check_range("load_factor", options.load_factor, -1, 1);
    check_range("target", options.target, 1, 1000);
    if (options.zone_stiffness_kpa) {
        for (const double kpa : *options.zone_stiffness_kpa) {
            check_range("zone_stiffness_kpa", kpa, 1, 10000);
        }
        check_range("tumour_fraction (with zones)", options.tumour_fraction, 0, 0);
    }
    for (int axis = 0; axis < 3; ++axis) check_range("spacing", options.spacing[axis], 0.3, 8);
}

Settings make_settings(const PelvisOptions& options) {
    Settings settings;
    settings.background = BackgroundSettings{};
    settings.background->stiffness_kpa = options.background_stiffness_kpa;
    settings.background->poisson_ratio = options.background_poisson_ratio;
    settings.organs = {
        {"prostate", 1, Role::tissue, false, {}, options.poisson_ratio},
        {"bladder", 2, Role::driven, true, {}, 0.40},
        {"rectum", 3, Role::driven, true, {}, 0.40},
        {"bone_left", 4, Role::fixed, true, {}, 0.40},
        {"bone_right", 5, Role::fixed, true, {}, 0.40},
    };
    if (options.zone_stiffness_kpa) {
        settings.organs[prostate].name = "peripheral_zone";
        settings.organs.push_back(
            {"transition_zone", 6, Role::tissue, false, {}, options.poisson_ratio});
    }
    return settings;
}

/// Of the prostate: its two zones, or the one that it has.
bool is_prostate(Index region) {
    return region == prostate_region || region == transition_zone_region;
}

/// By region number, the tumour's last; hollow regions hold no tets, their entries are never used.
std::vector<LinearElastic> make_materials(const PelvisOptions& options, Index num_regions) {
    std::vector<LinearElastic> materials(num_regions + 1);
    materials[background_region] = {options.background_stiffness_kpa,
                                    options.background_poisson_ratio};
    materials[prostate_region] = {options.stiffness_kpa, options.poisson_ratio};
    materials.back() = {options.tumour_stiffness_kpa, options.poisson_ratio};
    if (options.zone_stiffness_kpa) {
        const auto& [transition, peripheral] = *options.zone_stiffness_kpa;
        materials[prostate_region].stiffness_kpa = peripheral;
        materials[transition_zone_region] = {transition, options.poisson_ratio};
    }
    return materials;
}

/// The mesh with the tumour as a region of its own, number `tumour_region`.
RegionMesh with_tumour(RegionMesh mesh, const PelvisAnatomy& anatomy, const PelvisOptions& options,
                       Index tumour_region) {
    mark_ball(mesh.mesh, prostate_region, tumour_region,
              tumour_centre(anatomy.organs[prostate], options.seed), options.tumour_fraction);
    return mesh;
}

/// What the truth's mesh is made of: tet4, the corners of the elements that are wanted, and the
/// field whose interfaces are its surfaces.
struct ReferenceMesh {
    RegionMesh corners;
    LabelField field;
};

ReferenceMesh make_reference_mesh(const PelvisAnatomy& anatomy, const PelvisOptions& options,
                                  MesherOptions mesher, MesherSummary& summary,
                                  const ProgressSink& progress) {
    // 30,000 nodes make edges of 1.9 mm on the organs; sizes follow from that.
    Index num_corners = options.num_nodes;
    if (options.element == ElementType::tet10) num_corners /= quadratic_nodes_per_corner;
    const double coarseness = std::cbrt(30000.0 / num_corners);
    mesher.num_nodes = num_corners;
    mesher.edge_length_mm = 1.9 * coarseness;
    mesher.outer_edge_length_mm = 12.0 * std::max(1.0, coarseness);

    const Settings settings = make_settings(options);
    // A lattice that no image has: on the image's own, the truth's surface would be the very one
    // that is found again from its voxels (0.02 mm apart instead of about 0.1).
    RegionImage image = fill_shapes(anatomy, grid_of_box(anatomy, Vec3::Constant(0.77)));
    if (options.zone_stiffness_kpa) {
        mark_zone(image, make_transition_zone(anatomy.organs[prostate], options.seed),
                  prostate_region, transition_zone_region);
    }
    LabelField field(image, settings.num_regions());
    SurfaceOptions surface_options;
    surface_options.edge_length_mm = mesher.edge_length_mm;
    surface_options.outer_edge_length_mm = mesher.outer_edge_length_mm;
    const RegionSurface surface =
        extract_surfaces(image, field, surface_options, nullptr, progress);
    RegionMesh corners =
        make_mesh(surface, image, field, hollow_regions, mesher, &summary, progress);
    return {std::move(corners), std::move(field)};
}

/// The label volume of the mesh with its nodes at `nodes`, drawn as `options` say. `image`: 0 for
/// the reference, the number of the target for a target; all are drawn independently.
RegionImage drawn_image(const RegionMesh& mesh, const std::vector<Vec3>& nodes,
                        const PelvisAnatomy& anatomy, const PelvisOptions& options,
                        Index num_regions, unsigned image) {
    const ImageGrid grid = grid_of_image(anatomy, options.spacing);
    if (options.contours.style == ContourStyle::exact)
        return regions_on_grid(mesh, nodes, hollow_regions, grid);
    const Vec3 fine = (0.6 * options.spacing).cwiseMax(0.3).cwiseMin(0.8);
    RegionImage truth = regions_on_grid(mesh, nodes, hollow_regions, grid_of_image(anatomy, fine));
    const std::uint64_t other_targets = image > 1 ? std::uint64_t(image) << 40 : 0;
    const std::uint64_t seed = 2ull * options.seed + std::min(image, 1u) + other_targets;
    if (!options.zone_stiffness_kpa)
        return drawn_regions(LabelField(truth, num_regions), grid, options.contours, seed);
    // One outline round both zones, and the border between them.
    const LabelField zones(truth, num_regions);
    std::ranges::replace(truth.voxels, transition_zone_region, prostate_region);
    RegionImage drawn = drawn_regions(LabelField(truth, num_regions), grid, options.contours, seed);
    draw_border(zones, prostate_region, transition_zone_region, options.contours, seed, drawn);
    return drawn;
}

LabelImage to_labels(const RegionImage& regions, const Settings& settings) {
    LabelImage labels{regions.grid, std::vector<std::uint16_t>(regions.voxels.size(), 0)};
    for (std::size_t v = 0; v < regions.voxels.size(); ++v) {
        const Index organ = regions.voxels[v] - first_organ_region;
        if (organ >= 0) labels.voxels[v] = static_cast<std::uint16_t>(settings.organs[organ].label);
    }
    return labels;
}

std::vector<Vec3> deformed_nodes(const PelvisPhantom& phantom) {
    std::vector<Vec3> nodes = phantom.mesh.mesh.nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] += phantom.displacement[n];
    return nodes;
}

/// Points spread evenly over the volume of the prostate, at least 2 mm below its surface.
void add_landmarks(PelvisPhantom& phantom, const PelvisAnatomy& anatomy, unsigned seed) {
    constexpr int num_landmarks = 200;
    constexpr double depth_mm = 2.0;
    const Mesh& mesh = phantom.mesh.mesh;
    std::vector<Index> tets;
    std::vector<double> volume_up_to;
    double volume = 0;
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        if (!is_prostate(mesh.region[t])) continue;
        tets.push_back(t);
        volume_up_to.push_back(volume += tet_volume(mesh, t));
    }
    RandomNumbers random(0x6c616e64ull * 1000003ull + seed);
    phantom.landmarks.clear();
    phantom.landmark_displacements.clear();
    while (phantom.landmarks.size() < num_landmarks) {
        const auto at = std::upper_bound(volume_up_to.begin(), volume_up_to.end() - 1,
                                         random.uniform(0, volume));
        const Tet& tet = mesh.tets[tets[at - volume_up_to.begin()]];
        // Exponential weights, scaled to sum one, are uniform barycentric coordinates.
        Eigen::Vector4d weights;
        for (double& w : weights) w = -std::log(random.uniform(1e-12, 1));
        weights /= weights.sum();
        Vec3 x = Vec3::Zero(), u = Vec3::Zero();
        for (int c = 0; c < 4; ++c) {
            x += weights[c] * mesh.nodes[tet[c]];
            u += weights[c] * phantom.displacement[tet[c]];
        }
        if (anatomy.organs[prostate].value(x) > -depth_mm) continue;
        phantom.landmarks.push_back(x);
        phantom.landmark_displacements.push_back(u);
    }
}

/// Rms and largest distance that the best rigid motion from `x` to `x + u` leaves (Kabsch).
std::pair<double, double> shape_change(const std::vector<Vec3>& x, const std::vector<Vec3>& u) {
    Vec3 centre = Vec3::Zero(), mean = Vec3::Zero();
    for (std::size_t n = 0; n < x.size(); ++n) {
        centre += x[n] / double(x.size());
        mean += u[n] / double(x.size());
    }
    Mat3 covariance = Mat3::Zero();
    for (std::size_t n = 0; n < x.size(); ++n) {
        covariance += (x[n] + u[n] - centre - mean) * (x[n] - centre).transpose();
    }
    const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    const Mat3 rotation = svd.matrixU() * Vec3(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
    double sum = 0, largest = 0;
    for (std::size_t n = 0; n < x.size(); ++n) {
        const Vec3 left = x[n] + u[n] - centre - mean - rotation * (x[n] - centre);
        sum += left.squaredNorm();
        largest = std::max(largest, left.norm());
    }
    return {std::sqrt(sum / double(x.size())), largest};
}

void describe_prostate(const PelvisPhantom& phantom, PelvisTruth& truth) {
    const auto on_prostate = nodes_on_region(phantom.mesh, prostate_region);
    const auto on_transition_zone = nodes_on_region(phantom.mesh, transition_zone_region);
    std::vector<Vec3> x, u;
    for (std::size_t n = 0; n < on_prostate.size(); ++n) {
        if (!on_prostate[n] && !on_transition_zone[n]) continue;
        x.push_back(phantom.mesh.mesh.nodes[n]);
        u.push_back(phantom.displacement[n]);
        truth.prostate_mean_displacement_mm += u.back().norm();
    }
    truth.prostate_mean_displacement_mm /= double(x.size());
    std::tie(truth.prostate_shape_change_mm, truth.prostate_largest_shape_change_mm) =
        shape_change(x, u);
}

void describe_walls(const PelvisPhantom& phantom, const std::vector<WallMotion>& motions,
                    const std::vector<Vec3>& forces, PelvisTruth& truth) {
    for (const WallMotion& motion : motions) {
        WallTruth wall{phantom.settings.organs[motion.organ()].name,
                       motion.expansion_mm(),
                       motion.push_mm(),
                       motion.tangential_mm(),
                       motion.shift_mm(),
                       Vec3::Zero()};
        const auto on_wall = nodes_on_region(phantom.mesh, first_organ_region + motion.organ());
        for (std::size_t n = 0; n < forces.size(); ++n) {
            if (on_wall[n]) wall.resultant_force_mn += forces[n];
        }
        truth.walls.push_back(wall);
    }
}

/// 1: that of the phantom; other loads are drawn as if for another phantom.
unsigned seed_of_load(unsigned seed, unsigned load) {
    if (load == 1) return seed;
    std::seed_seq mixed{0x6c6f6164u, seed, load};
    std::array<unsigned, 1> one{};
    mixed.generate(one.begin(), one.end());
    return one[0];
}

PelvisTruth truth_of(const PelvisPhantom& phantom, const std::vector<WallMotion>& motions,
                     const Deformation& deformation) {
    PelvisTruth truth;
    truth.mesher = phantom.truth.mesher;
    truth.load_scale = deformation.load_scale;
    truth.smallest_jacobian = deformation.smallest_jacobian;
    truth.solve_residual = deformation.relative_residual;
    for (const Vec3& u : phantom.displacement) {
        truth.peak_displacement_mm = std::max(truth.peak_displacement_mm, u.norm());
    }
    describe_prostate(phantom, truth);
    describe_walls(phantom, motions, deformation.force, truth);
    return truth;
}

/// The target of the first load is drawn as number `first_target`, the next ones follow.
void deform_and_draw(const PelvisOptions& options, const std::vector<unsigned>& loads,
                     unsigned first_target, const LinearSolverOptions& solver,
                     const MesherOptions& mesher, const PelvisSink& take,
                     const ProgressSink& progress) {
    const PelvisAnatomy anatomy = make_anatomy(options.seed, options.spacing, options.anatomy);
    PelvisPhantom phantom;
    phantom.settings = make_settings(options);
    phantom.element = options.element;
    const Index num_regions = phantom.settings.num_regions();
    const auto [corners, field] =
        make_reference_mesh(anatomy, options, mesher, phantom.truth.mesher, progress);
    phantom.mesh = linear_pieces_of(curved_along(field, body_mesh(corners, options.element)));

    std::vector<LoadFamily> families;
    std::vector<std::vector<WallMotion>> motions;
    for (const unsigned load : loads) {
        const unsigned seed = seed_of_load(options.seed, load);
        families.push_back(drawn_for(options.load, seed));
        motions.push_back(
            make_wall_motions(anatomy, seed, options.tangential_factor, families.back()));
    }
    BodyMesh truth_body =
        body_mesh(with_tumour(corners, anatomy, options, num_regions), options.element);
    truth_body.mesh.nodes = phantom.mesh.mesh.nodes;
    truth_body.surface.vertices = phantom.mesh.surface.vertices;
    const std::vector<Deformation> deformations =
        deform_by_walls(truth_body, make_materials(options, num_regions), motions,
                        options.load_factor, options.law, solver, progress);

    const auto labels = [&](const std::vector<Vec3>& nodes, unsigned image) {
        return to_labels(drawn_image(phantom.mesh, nodes, anatomy, options, num_regions, image),
                         phantom.settings);
    };
    phantom.reference = labels(phantom.mesh.mesh.nodes, 0);
    for (std::size_t k = 0; k < loads.size(); ++k) {
        report_progress(progress, "voxelising", double(k) / double(loads.size()));
        phantom.displacement = deformations[k].displacement;
        phantom.target = labels(deformed_nodes(phantom), first_target + unsigned(k));
        add_landmarks(phantom, anatomy, options.seed);
        phantom.truth = truth_of(phantom, motions[k], deformations[k]);
        phantom.truth.load = loads[k];
        phantom.truth.load_family = families[k];
        take(phantom);
    }
    report_progress(progress, "voxelising", 1);
}

}  // namespace

RegionMesh make_pelvis_mesh(const PelvisOptions& options, const MesherOptions& mesher,
                            const ProgressSink& progress) {
    check_options(options);
    MesherSummary summary;
    return make_reference_mesh(make_anatomy(options.seed, options.spacing, options.anatomy),
                               options, mesher, summary, progress)
        .corners;
}

WallProblem make_pelvis_problem(const PelvisOptions& options, const MesherOptions& mesher,
                                const ProgressSink& progress) {
    check_options(options);
    const PelvisAnatomy anatomy = make_anatomy(options.seed, options.spacing, options.anatomy);
    MesherSummary summary;
    const RegionMesh mesh =
        make_reference_mesh(anatomy, options, mesher, summary, progress).corners;
    const Index num_regions = make_settings(options).num_regions();
    return make_wall_problem(with_tumour(mesh, anatomy, options, num_regions),
                             make_materials(options, num_regions),
                             make_wall_motions(anatomy, options.seed, options.tangential_factor,
                                               drawn_for(options.load, options.seed)));
}

void make_pelvis_loads(const PelvisOptions& options, unsigned num_loads,
                       const LinearSolverOptions& solver, const MesherOptions& mesher,
                       const PelvisSink& take, const ProgressSink& progress) {
    check_options(options);
    check_range("number of loads", num_loads, 1, 1000);
    std::vector<unsigned> loads(num_loads);
    std::iota(loads.begin(), loads.end(), 1u);
    deform_and_draw(options, loads, 1, solver, mesher, take, progress);
}

PelvisPhantom make_pelvis(const PelvisOptions& options, const LinearSolverOptions& solver,
                          const MesherOptions& mesher, const ProgressSink& progress) {
    check_options(options);
    PelvisPhantom made;
    deform_and_draw(
        options, {1}, options.target, solver, mesher,
        [&](const PelvisPhantom& phantom) { made = phantom; }, progress);
    return made;
}

}  // namespace palpate
