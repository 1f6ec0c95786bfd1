// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// The only file that uses CGAL Mesh_3 (GPL-3.0-or-later): a program built with it is under that
// licence.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/version.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "host/geometry/mesh_tool/label_grid.hpp"
#include "host/geometry/mesh_tool/mesh_job.hpp"
#include "host/geometry/mesh_tool/node_mover.hpp"
#include "host/geometry/mesh_tool/region_fill.hpp"
#include "solver/base/error.hpp"

namespace palpate::mesh_tool {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Mesh_domain_with_polyline_features_3<CGAL::Labeled_mesh_domain_3<Kernel>>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index,
                                                        Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
using Point = Domain::Point_3;

constexpr double growth = 0.35;          ///< of the edge length, mm per mm from an interface
constexpr double node_tolerance = 0.15;  ///< of the wanted number of nodes
constexpr int max_tries = 5;
constexpr double volume_tolerance = 0.035;
constexpr double facet_angle_deg = 25;
constexpr double least_facet_distance = 0.04;  ///< of the edge length
constexpr double radius_edge_ratio = 2.5;
constexpr double surface_error = 1e-5;  ///< of the size of the box, of points on interfaces
constexpr double exude_deg = 8;         ///< dihedral angles below are improved by weights
constexpr double perturb_deg = 6;  ///< ... and by moving nodes; reached within a second, 12 never
constexpr double sliver_deg = 10;  ///< ... and by moving nodes once more, surfaces too
constexpr double improve_limit_s = 30;  ///< for inputs that never settle: usual is below 1 s
constexpr double seed_distance = 0.25;  ///< of the edge length, between seeds
constexpr double on_box = 1e-3;         ///< of the edge length: hull nodes that near lie on the box

Vec3 to_vec(const Point& p) { return {p.x(), p.y(), p.z()}; }
Point to_point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// Wanted size at a point times `factor`: fine near interfaces, growing away from them.
struct Sizing {
    using FT = Domain::FT;
    using Point_3 = Domain::Point_3;
    using Index = Domain::Index;

    const LabelGrid* labels;
    double edge, outer, factor;

    double operator()(const Point_3& p, int, const Index&) const {
        return factor * std::min(outer, edge + growth * labels->interface_distance(to_vec(p)));
    }
};

/// How far facets may be from the interface (mm), by region number: an interface takes the smaller
/// value of its two regions.
struct Closeness {
    using FT = Domain::FT;
    using Point_3 = Domain::Point_3;
    using Index = Domain::Index;

    std::vector<double> by_region;

    double operator()(const Point_3&, int, const Index& index) const {
        const auto* patch = boost::get<Domain::Surface_patch_index>(&index);
        return patch ? std::min(by_region[patch->first], by_region[patch->second]) : by_region[0];
    }
};

Criteria make_criteria(const LabelGrid& labels, const Closeness& closeness, double edge,
                       double outer) {
    namespace p = CGAL::parameters;
    // Mesh_3 bounds radii; the radius round a regular triangle or tet of edge 1 is about 0.6, and
    // the edges of a refined mesh come out at about 0.8 of the bound
    return Criteria(p::edge_size = Sizing{&labels, edge, outer, 1.0},
                    p::facet_angle = facet_angle_deg,
                    p::facet_size = Sizing{&labels, edge, outer, 0.75},
                    p::facet_distance = closeness, p::cell_radius_edge_ratio = radius_edge_ratio,
                    p::cell_size = Sizing{&labels, edge, outer, 0.75});
}

/// The box with its twelve edges as curves that the mesh must keep.
Domain make_domain(const LabelGrid& labels) {
    const Vec3 low = labels.box_low(), high = labels.box_high();
    const Vec3 margin = 0.05 * (high - low);
    const Point from = to_point(low - margin), to = to_point(high + margin);
    Domain domain([&labels](const Point& p) { return labels.region_at(to_vec(p)); },
                  Kernel::Iso_cuboid_3(from, to),
                  CGAL::parameters::relative_error_bound = surface_error);
    std::vector<std::vector<Point>> edges;
    for (int axis = 0; axis < 3; ++axis) {
        for (int corner = 0; corner < 4; ++corner) {
            Vec3 a = low;
            if (corner & 1) a[(axis + 1) % 3] = high[(axis + 1) % 3];
            if (corner & 2) a[(axis + 2) % 3] = high[(axis + 2) % 3];
            Vec3 b = a;
            b[axis] = high[axis];
            edges.push_back({to_point(a), to_point(b)});
        }
    }
    domain.add_features(edges.begin(), edges.end());
    return domain;
}

/// Protects the box edges, then seeds every connected part of every region with points of its
/// surface, so that none is overlooked.
void start(Complex& complex, const Domain& domain, const Criteria& criteria,
           const std::vector<InterfacePoint>& seeds) {
    CGAL::Mesh_3::internal::init_c3t3_with_features(complex, domain, criteria);
    auto& triangulation = complex.triangulation();
    const auto weighted = triangulation.geom_traits().construct_weighted_point_3_object();
    for (const InterfacePoint& seed : seeds) {
        const auto vertex = triangulation.insert(weighted(to_point(seed.point)));
        if (vertex == Triangulation::Vertex_handle() || complex.in_dimension(vertex) >= 0) continue;
        complex.set_dimension(vertex, 2);
        complex.set_index(vertex, domain.index_from_surface_patch_index(
                                      std::minmax(seed.regions[0], seed.regions[1])));
    }
}

void refine(Complex& complex, const Domain& domain, const Criteria& criteria) {
    namespace p = CGAL::parameters;
    CGAL::refine_mesh_3(complex, domain, criteria, p::no_perturb(), p::no_exude(),
                        p::no_reset_c3t3());
}

void improve(Complex& complex, const Domain& domain) {
    namespace p = CGAL::parameters;
    // In this order: moving nodes takes a mesh without weights, and would forget them.
    CGAL::perturb_mesh_3(complex, domain, p::time_limit = improve_limit_s,
                         p::sliver_bound = perturb_deg);
    CGAL::exude_mesh_3(complex, p::time_limit = improve_limit_s, p::sliver_bound = exude_deg);
}

Mesh to_mesh(const Complex& complex) {
    Mesh mesh;
    std::unordered_map<const void*, Index> number;
    for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end();
         ++cell) {
        Tet tet{};
        for (int k = 0; k < 4; ++k) {
            const auto vertex = cell->vertex(k);
            const auto [entry, fresh] =
                number.emplace(&*vertex, static_cast<Index>(mesh.nodes.size()));
            if (fresh) mesh.nodes.push_back(to_vec(vertex->point().point()));
            tet[k] = entry->second;
        }
        mesh.tets.push_back(tet);
        mesh.region.push_back(complex.subdomain_index(cell));
    }
    return mesh;
}

Closeness first_closeness(const VolumeJob& job) {
    const Index largest = *std::max_element(job.region_numbers.begin(), job.region_numbers.end());
    const double most = *std::max_element(job.facet_distances.begin(), job.facet_distances.end());
    Closeness closeness{std::vector<double>(std::size_t(largest) + 1, most)};
    for (std::size_t r = 0; r < job.region_numbers.size(); ++r)
        closeness.by_region[job.region_numbers[r]] = job.facet_distances[r];
    return closeness;
}

/// Asks for closer facets where a region lost volume; false if there was no need.
bool tighten(Closeness& closeness, const Mesh& mesh, const VolumeJob& job) {
    std::vector<double> volume(closeness.by_region.size(), 0.0);
    for (Index t = 0; t < mesh.num_tets(); ++t)
        volume[mesh.region[t]] += std::abs(tet_volume(mesh, t));
    bool tightened = false;
    for (std::size_t r = 0; r < job.region_numbers.size(); ++r) {
        const Index region = job.region_numbers[r];
        const double wanted = job.volumes[r];
        if (region == 0 || std::abs(volume[region] - wanted) <= volume_tolerance * wanted) continue;
        double& distance = closeness.by_region[region];
        if (distance <= least_facet_distance * job.edge_length_mm) continue;
        distance *= 0.5;
        tightened = true;
    }
    return tightened;
}

/// Nodes of the hull that lie on the box but for the search error are put exactly there.
void snap_to_box(MeshReply& reply, const Vec3& low, const Vec3& high, double tolerance) {
    for (std::size_t i = 0; i < reply.triangles.size(); ++i) {
        if (reply.regions[i][0] != 0 && reply.regions[i][1] != 0) continue;
        for (Index node : reply.triangles[i])
            for (int axis = 0; axis < 3; ++axis) {
                double& x = reply.mesh.nodes[node][axis];
                if (std::abs(x - low[axis]) < tolerance) x = low[axis];
                if (std::abs(x - high[axis]) < tolerance) x = high[axis];
            }
    }
}

}  // namespace

std::string cgal_name() { return "CGAL " CGAL_VERSION_STR; }

MeshReply mesh_with_cgal(const VolumeJob& job) {
    CGAL::get_default_random() = CGAL::Random(0);
    const LabelGrid labels(job);
    const Domain domain = make_domain(labels);
    Closeness closeness = first_closeness(job);
    const auto seeds = labels.interface_points(seed_distance * job.edge_length_mm);
    Complex complex;
    double scale = 1;
    for (int i = 0; i < max_tries; ++i) {
        complex = Complex();
        const Criteria criteria = make_criteria(labels, closeness, scale * job.edge_length_mm,
                                                scale * job.outer_edge_length_mm);
        start(complex, domain, criteria, seeds);
        refine(complex, domain, criteria);
        const Mesh mesh = to_mesh(complex);
        const double ratio = static_cast<double>(mesh.nodes.size()) / job.num_nodes;
        const bool tightened = tighten(closeness, mesh, job);
        if (std::abs(ratio - 1) <= node_tolerance && !tightened) break;
        scale *= std::clamp(std::pow(ratio, 1 / 2.6), 0.4, 2.5);
    }
    improve(complex, domain);

    MeshReply reply;
    reply.mesh = to_mesh(complex);
    if (reply.mesh.tets.empty()) throw Error(ErrorCode::mesh_failed, "CGAL returned no mesh");
    turn_to_positive_volume(reply.mesh);
    interfaces_between_regions(reply.mesh, reply.triangles, reply.regions);
    move_nodes_of_slivers(reply.mesh, reply.triangles, SurfaceNodes::slide, sliver_deg);
    snap_to_box(reply, job.box_low, job.box_high, on_box * job.edge_length_mm);
    keep_meshed(reply, job.hollow);
    return reply;
}

}  // namespace palpate::mesh_tool
