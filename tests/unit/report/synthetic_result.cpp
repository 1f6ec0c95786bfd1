// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/report/synthetic_result.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

/// An organ as a bumpy ellipsoid, LPS mm.
struct Organ {
    Index region, label;
    const char* name;
    Role role;
    Vec3 centre, radii;
    double bumps;

    double level(const Vec3& x) const {
        const Vec3 q = (x - centre).cwiseQuotient(radii);
        const double angle = std::atan2(q.y(), q.x());
        return q.norm() /
               (1 + bumps * std::sin(3 * angle + 0.1 * x.z()) * std::exp(-q.z() * q.z()));
    }
};

const std::vector<Organ>& organs() {
    static const std::vector<Organ> list{
        {2, 1, "prostate, transition zone", Role::tissue, {0, 0, 0}, {20, 14, 17}, 0.03},
        {3, 2, "prostate, peripheral zone", Role::tissue, {0, 5, -3}, {25, 17, 19}, 0.02},
        {4, 3, "bladder", Role::driven, {1, -8, 40}, {36, 28, 24}, 0.04},
        {5, 4, "rectum", Role::driven, {3, 38, 5}, {15, 14, 42}, 0.06},
        {6, 6, "pubic bone", Role::fixed, {0, -42, -4}, {32, 9, 12}, 0.08}};
    return list;
}

/// The bladder fills and pushes the prostate down and back.
Vec3 true_displacement(const Vec3& x) {
    const auto bump = [&](const Vec3& c, double width) {
        return std::exp(-(x - c).squaredNorm() / (2 * width * width));
    };
    return Vec3(0.5, 4.5, -5.0) * bump({0, 0, 12}, 22) +
           Vec3(0, -2.5, 1.0) * bump({2, -35, 45}, 18) +
           0.09 * (x - Vec3(1, -8, 40)) * bump({1, -8, 40}, 26);
}

double misfit_mm(const Vec3& x) {
    return 0.25 * std::sin(0.31 * x.x()) * std::cos(0.27 * x.z() + 1);
}

Surface surface_of(const Organ& organ) {
    constexpr int rings = 28, sectors = 48;
    Surface s;
    for (int r = 0; r <= rings; ++r)
        for (int c = 0; c < sectors; ++c) {
            const double a = std::numbers::pi * r / rings, b = 2 * std::numbers::pi * c / sectors;
            const Vec3 unit(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
            const Vec3 x = organ.centre + unit.cwiseProduct(organ.radii);
            s.vertices.push_back(organ.centre + (x - organ.centre) / organ.level(x));
        }
    for (int r = 0; r < rings; ++r)
        for (int c = 0; c < sectors; ++c) {
            const Index a = r * sectors + c, b = r * sectors + (c + 1) % sectors;
            s.triangles.push_back({a, a + sectors, b});
            s.triangles.push_back({b, a + sectors, b + sectors});
        }
    return s;
}

std::vector<Vec3> normals_of(const Surface& s) {
    std::vector<Vec3> normals(s.vertices.size(), Vec3::Zero());
    for (const Triangle& t : s.triangles) {
        const Vec3 n =
            (s.vertices[t[1]] - s.vertices[t[0]]).cross(s.vertices[t[2]] - s.vertices[t[0]]);
        for (Index v : t) normals[v] += n;
    }
    for (Vec3& n : normals)
        if (n.norm() > 0) n.normalize();
    return normals;
}

/// Fills the organ with tets between its triangles and a node in its middle.
void add_tets(const Organ& organ, const SurfaceResult& s, RecoveryResult& result) {
    SolidMesh& mesh = result.mesh;
    const Index middle = mesh.num_nodes();
    mesh.nodes.push_back(organ.centre);
    result.displacement.push_back(Vec3::Zero());
    result.force.push_back(Vec3::Zero());
    for (const Triangle& t : s.reference.triangles) {
        const Tet tet{middle, s.node_of[t[0]], s.node_of[t[1]], s.node_of[t[2]]};
        const auto at = [&](int k) { return mesh.nodes[tet[k]]; };
        if (tet_volume(at(0), at(1), at(2), at(3)) < 1e-3) continue;  // at the poles
        mesh.elements.insert(mesh.elements.end(), tet.begin(), tet.end());
        mesh.region.push_back(organ.region);
        result.element_stiffness_kpa.push_back(10.0 * organ.region);
    }
}

SurfaceResult surface_result(const Organ& organ, RecoveryResult& result) {
    SurfaceResult s;
    s.region = organ.region;
    s.name = organ.name;
    s.role = organ.role;
    s.cut_by_image = s.name == "rectum";
    s.reference = surface_of(organ);
    const std::vector<Vec3> normals = normals_of(s.reference);
    const bool moves = s.role != Role::fixed;
    for (std::size_t v = 0; v < s.reference.vertices.size(); ++v) {
        const Vec3 x = s.reference.vertices[v];
        const Vec3 u = moves ? true_displacement(x) : Vec3(0, 0, 0);
        s.target.vertices.push_back(x + u);
        s.node_of.push_back(result.mesh.num_nodes());
        s.distance_before_mm.push_back(-u.dot(normals[v]));
        s.distance_after_mm.push_back(moves ? misfit_mm(x) : 0);
        result.mesh.nodes.push_back(x);
        result.displacement.push_back(u + (moves ? misfit_mm(x) : 0) * normals[v]);
        result.force.push_back(s.role == Role::driven ? Vec3(3 * u) : Vec3(0, 0, 0));
        s.resultant_force_mn += result.force.back();
    }
    add_tets(organ, s, result);
    s.target.triangles = s.reference.triangles;
    s.dice_before = moves ? 0.86 : 1;
    s.dice_after = moves ? 0.98 : 1;
    for (std::size_t v = 0; v < s.node_of.size(); ++v) {
        s.mean_distance_mm_before += std::abs(s.distance_before_mm[v]) / s.node_of.size();
        s.mean_distance_mm_after += std::abs(s.distance_after_mm[v]) / s.node_of.size();
        s.max_distance_mm_before =
            std::max(s.max_distance_mm_before, std::abs(s.distance_before_mm[v]));
        s.max_distance_mm_after =
            std::max(s.max_distance_mm_after, std::abs(s.distance_after_mm[v]));
    }
    s.hausdorff95_mm_before = 0.9 * s.max_distance_mm_before;
    s.hausdorff95_mm_after = 0.9 * s.max_distance_mm_after;
    return s;
}

ImageGrid grid() {
    ImageGrid g;
    g.size = {60, 65, 40};
    g.spacing = {2, 2, 3};
    g.direction = Eigen::AngleAxisd(0.1, Vec3::UnitX()).toRotationMatrix();
    g.origin = -(g.direction * Vec3(60, 62, 54));
    return g;
}

std::uint16_t label_at(const Vec3& x) {
    for (const Organ& organ : organs())
        if (organ.level(x) < 1) return organ.label;
    return 0;
}

RigidTransform alignment() {
    return {Eigen::AngleAxisd(0.02, Vec3::UnitZ()).toRotationMatrix(), Vec3(1.27, 0.71, -0.22)};
}

/// The reference labels as they look in the target's frame after `part` of the displacement
/// (inverted approximately).
LabelImage labels(double part) {
    LabelImage image{grid(), {}};
    for (Index k = 0; k < image.grid.size[2]; ++k)
        for (Index j = 0; j < image.grid.size[1]; ++j)
            for (Index i = 0; i < image.grid.size[0]; ++i) {
                const Vec3 y = alignment().inverse().apply(image.grid.to_point(Vec3(i, j, k)));
                Vec3 x = y;
                for (int step = 0; step < 2; ++step) x = y - part * true_displacement(x);
                const bool fixed = label_at(y) == 6;
                image.voxels.push_back(fixed ? 6 : label_at(x));
            }
    return image;
}

void add_regions(RecoveryResult& r) {
    r.regions.push_back({1,
                         "background",
                         0,
                         Role::background,
                         false,
                         false,
                         0.35,
                         10,
                         {10, 10},
                         0,
                         Verdict::given,
                         "reference tissue"});
    r.regions.push_back({2,
                         organs()[0].name,
                         1,
                         Role::tissue,
                         false,
                         true,
                         0.4,
                         83.24,
                         {61.4, 112.8},
                         0.155,
                         Verdict::recovered,
                         "the interval is narrower than a factor of 2"});
    r.regions.push_back({3,
                         organs()[1].name,
                         2,
                         Role::tissue,
                         false,
                         true,
                         0.4,
                         41.7,
                         {18.2, 95.6},
                         0.423,
                         Verdict::weak,
                         "the interval is wider than a factor of 2"});
    r.regions.push_back(
        {4, "bladder", 3, Role::driven, true, false, 0, 0, {0, 0}, 0, Verdict::hollow, ""});
    r.regions.push_back(
        {5, "rectum", 4, Role::driven, true, false, 0, 0, {0, 0}, 0, Verdict::hollow, ""});
    r.regions.push_back(
        {6, "pubic bone", 6, Role::fixed, true, false, 0, 0, {0, 0}, 0, Verdict::hollow, ""});
    r.correlation = {{1, -0.42}, {-0.42, 1}};
    r.sensitivity = {{7.6, {0.97, -0.24}}, {2.4, {0.24, 0.97}}};
}

void add_search(RecoveryResult& r) {
    for (const auto& [region, e, sd] : {std::tuple{2, 83.24, 0.155}, std::tuple{3, 41.7, 0.423}}) {
        ProfileResult p{region, {}, {}};
        for (int i = -10; i <= 10; ++i) {
            const double z = 0.32 * i;
            p.stiffness_kpa.push_back(e * std::exp(z * sd));
            p.objective.push_back(0.5 * z * z * (1 - 0.05 * z));
        }
        r.profiles.push_back(p);
    }
    for (int i = 0; i <= 9; ++i)
        r.convergence.push_back(
            {i,
             210 + 5200 * std::exp(-1.1 * i),
             40 * std::exp(-1.6 * i),
             2 * std::exp(-1.2 * i),
             {83.24 - 60 * std::exp(-0.7 * i), 41.7 + 50 * std::exp(-0.6 * i)}});
    r.termination = {true, "the scaled gradient fell below 1e-4", 9};
    r.timings_s = {{"reading", 0.8},     {"surfaces", 4.1},   {"meshing", 6.3},
                   {"condensing", 28.4}, {"searching", 41.9}, {"warping", 3.2}};
    r.contours = ContourError{0.42, 7.0, false};
    r.full_model_residual = 3.1e-9;
    r.device = {"opencl",
                "Portable Computing Language",
                "pthread-cpu",
                "3.1",
                Precision::single,
                Product::assembled,
                {},
                2,
                "CPU"};
    BackendInfo host;
    host.backend = "reference";
    host.device = "host";
    r.linear_solvers = {
        {"condensing",
         {host, LinearMethod::direct, "Eigen 3.4.0 LDLT",
          "17,646 degrees of freedom and 3,402 columns: factorising once on the host is "
          "cheapest"}},
        {"solving", {r.device, LinearMethod::jacobi, "", "asked for"}}};
}

void add_settings(RecoveryResult& r) {
    r.settings.background = BackgroundSettings{};
    for (const Organ& organ : organs()) {
        r.settings.organs.push_back(
            {organ.name, organ.label, organ.role, organ.role != Role::tissue, std::nullopt, 0.4});
    }
    r.settings_toml = "# the text of the file, which may name SECRETPATIENT\n";
}

}  // namespace

RecoveryResult synthetic_result() {
    RecoveryResult r;
    r.version = "0.1.0";
    r.reference_name = "SECRETPATIENT_reference.nii.gz";
    r.target_name = "SECRETPATIENT_target.nii.gz";
    for (const Organ& organ : organs()) r.surfaces.push_back(surface_result(organ, r));
    add_regions(r);
    add_search(r);
    add_settings(r);
    r.alignment.method = "fixed";
    r.alignment.reference_to_target = alignment();
    r.alignment.mean_distance_mm = 0.21;
    r.mesher = {"TetGen 1.5.0", "", {}, 6.3};
    r.mesher.quality.min_dihedral_deg = 8.4;
    r.warnings = {"rectum is cut by the field of view at both ends"};
    r.reference_labels = labels(0);
    r.target_labels_aligned = labels(1);
    r.warped_labels = labels(0.94);
    r.displacement_field.grid = grid();
    for (std::size_t v = 0; v < grid().num_voxels(); ++v)
        r.displacement_field.voxels.push_back(Vec3(1, 2, 3));
    r.inverse_displacement_field.grid = grid();
    for (std::size_t v = 0; v < grid().num_voxels(); ++v)
        r.inverse_displacement_field.voxels.push_back(Vec3(-1, -2, -3));
    r.held.assign(r.mesh.nodes.size(), Held::free);
    r.held[5] = Held::driven;
    return r;
}

}  // namespace palpate
