// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// The only file that uses TetGen (AGPL-3.0-or-later): a program built with it is under that
// licence.
#include <cmath>
#include <limits>
#include <map>

#define TETLIBRARY
#include <tetgen.h>

#include "host/geometry/mesh_tool/mesh_job.hpp"
#include "host/geometry/mesh_tool/region_fill.hpp"
#include "host/geometry/mesh_tool/size_field.hpp"
#include "host/geometry/mesh_tool/surface_checks.hpp"
#include "solver/base/error.hpp"

namespace palpate::mesh_tool {

namespace {

constexpr double growth = 0.35;    ///< of the edge length, mm per mm from the surface
constexpr double shrinkage = 0.5;  ///< of the edge length where more nodes are wanted, mm per mm
constexpr double node_tolerance = 0.15;  ///< of the wanted number of nodes
constexpr int max_tries = 5;

/// Wanted edge length: that of the surface on it, growing away from it, all times `scale`. A finer
/// mesh (scale < 1) is only made some way from the surface, whose triangles stay as they are.
struct Sizing {
    SizeField natural, distance;
    double scale = 1;

    Sizing(const SurfaceJob& job)
        : natural(job.vertices, mean_edge_lengths(job.vertices, job.triangles), growth,
                  job.outer_edge_length_mm),
          distance(job.vertices, std::vector<double>(job.vertices.size(), 1e-9), 1, 1e9) {}

    double at(const Vec3& point) const {
        const double size = natural.at(point);
        if (scale >= 1) return scale * size;
        return std::max(scale * size, size - shrinkage * distance.at(point));
    }
};

/// TetGen asks through a plain function: the sizing it reads, set for the run.
const Sizing* current_sizing = nullptr;

bool too_large(REAL* a, REAL* b, REAL* c, REAL* d, REAL*, REAL) {
    const Vec3 p0 = Vec3::Map(a), p1 = Vec3::Map(b), p2 = Vec3::Map(c), p3 = Vec3::Map(d);
    const double edge = current_sizing->at((p0 + p1 + p2 + p3) / 4);
    const double regular = edge * edge * edge / (6 * std::sqrt(2.0));
    return std::abs(tet_volume(p0, p1, p2, p3)) > regular;
}

void fill_input(const SurfaceJob& job, const std::vector<Vec3>& holes, tetgenio& in) {
    in.firstnumber = 0;
    in.numberofpoints = static_cast<int>(job.vertices.size());
    in.pointlist = new REAL[job.vertices.size() * 3];
    for (std::size_t i = 0; i < job.vertices.size(); ++i)
        Vec3::Map(in.pointlist + 3 * i) = job.vertices[i];
    in.numberoffacets = static_cast<int>(job.triangles.size());
    in.facetlist = new tetgenio::facet[job.triangles.size()];
    in.facetmarkerlist = new int[job.triangles.size()];
    for (std::size_t i = 0; i < job.triangles.size(); ++i) {
        tetgenio::facet& facet = in.facetlist[i];
        tetgenio::init(&facet);
        facet.numberofpolygons = 1;
        facet.polygonlist = new tetgenio::polygon[1];
        tetgenio::init(&facet.polygonlist[0]);
        facet.polygonlist[0].numberofvertices = 3;
        facet.polygonlist[0].vertexlist = new int[3];
        for (int k = 0; k < 3; ++k) facet.polygonlist[0].vertexlist[k] = job.triangles[i][k];
        in.facetmarkerlist[i] = static_cast<int>(i) + 1;  // all different: none are merged
    }
    in.numberofholes = static_cast<int>(holes.size());
    in.holelist = new REAL[holes.size() * 3 + 1];
    for (std::size_t i = 0; i < holes.size(); ++i) Vec3::Map(in.holelist + 3 * i) = holes[i];
}

Mesh to_mesh(const tetgenio& out) {
    Mesh mesh;
    mesh.nodes.resize(out.numberofpoints);
    for (int i = 0; i < out.numberofpoints; ++i) mesh.nodes[i] = Vec3::Map(out.pointlist + 3 * i);
    mesh.tets.resize(out.numberoftetrahedra);
    for (int t = 0; t < out.numberoftetrahedra; ++t) {
        for (int k = 0; k < 4; ++k)
            mesh.tets[t][k] = out.tetrahedronlist[t * out.numberofcorners + k];
    }
    turn_to_positive_volume(mesh);
    return mesh;
}

Mesh run_tetgen(const SurfaceJob& job, const std::vector<Vec3>& holes, std::string switches,
                bool sized) {
    tetgenio in, out;
    fill_input(job, holes, in);
    if (sized) in.tetunsuitable = too_large;
    try {
        tetrahedralize(switches.data(), &in, &out);
    } catch (int code) {  // TetGen throws its exit codes
        throw Error(ErrorCode::mesh_failed,
                    code == 3   ? "TetGen found triangles that cross each other"
                    : code == 1 ? "TetGen ran out of memory"
                                : "TetGen gave up with its code " + std::to_string(code));
    }
    if (out.numberoftetrahedra <= 0 || out.numberofpoints < in.numberofpoints)
        throw Error(ErrorCode::mesh_failed, "TetGen returned no mesh");
    Mesh mesh = to_mesh(out);
    for (std::size_t i = 0; i < job.vertices.size(); ++i)
        if (mesh.nodes[i] != job.vertices[i])
            throw Error(ErrorCode::mesh_failed, "TetGen moved a vertex of the surface");
    return mesh;
}

/// One point inside every connected part of space that is not to be meshed: the centre of the
/// largest tet of a mesh of the surface without quality.
std::vector<Vec3> points_in_holes(const SurfaceJob& job) {
    const Mesh mesh = run_tetgen(job, {}, "pYJQz", false);
    std::vector<Index> part;
    const std::vector<Index> region = fill_regions(mesh.tets, job.triangles, job.regions, &part);
    std::map<Index, Index> largest;
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        if (is_meshed(region[t], job.hollow)) continue;
        const auto [entry, fresh] = largest.emplace(part[t], t);
        if (!fresh && tet_volume(mesh, t) > tet_volume(mesh, entry->second)) entry->second = t;
    }
    std::vector<Vec3> points;
    for (const auto& [number, t] : largest) {
        const Tet& tet = mesh.tets[t];
        points.push_back(
            (mesh.nodes[tet[0]] + mesh.nodes[tet[1]] + mesh.nodes[tet[2]] + mesh.nodes[tet[3]]) /
            4);
    }
    return points;
}

/// The triangles that have a meshed region on one side at least: TetGen empties holes with what
/// stands in them.
SurfaceJob without_walls_in_holes(const SurfaceJob& job, std::vector<Index>& source) {
    SurfaceJob kept = job;
    kept.triangles.clear();
    kept.regions.clear();
    for (std::size_t i = 0; i < job.triangles.size(); ++i) {
        const auto& sides = job.regions[i];
        if (!is_meshed(sides[0], job.hollow) && !is_meshed(sides[1], job.hollow)) continue;
        kept.triangles.push_back(job.triangles[i]);
        kept.regions.push_back(sides);
        source.push_back(static_cast<Index>(i));
    }
    if (kept.triangles.empty())
        throw Error(ErrorCode::mesh_failed, "every region of the surface is hollow");
    return kept;
}

std::string quality_switches(const SurfaceJob& job) {
    return "pYJQzq" + std::to_string(job.radius_edge_ratio) + "/" +
           std::to_string(job.min_dihedral_deg) + "o/" + std::to_string(job.max_dihedral_deg);
}

}  // namespace

std::string tetgen_name() { return "TetGen " PALPATE_TETGEN_VERSION; }

MeshReply mesh_with_tetgen(const SurfaceJob& job) {
    check_surface(job);
    const std::vector<Vec3> holes = points_in_holes(job);
    Sizing sizing(job);
    current_sizing = &sizing;

    MeshReply reply;
    const SurfaceJob bounding = without_walls_in_holes(job, reply.source);
    // The nodes of the surface are given; those inside go with the inverse cube of the edge length.
    const double num_given = static_cast<double>(job.vertices.size());
    const double num_inside = std::max(job.num_nodes - num_given, 0.05 * num_given);
    double least_miss = std::numeric_limits<double>::infinity();
    for (int i = 0; i < max_tries && least_miss > node_tolerance * job.num_nodes; ++i) {
        Mesh mesh = run_tetgen(bounding, holes, quality_switches(job), true);
        const double num_nodes = static_cast<double>(mesh.nodes.size());
        const double ratio = std::max(num_nodes - num_given, 1.0) / num_inside;
        sizing.scale *= std::clamp(std::cbrt(ratio), 0.3, 2.5);
        const double miss = std::abs(num_nodes - job.num_nodes);
        if (miss >= least_miss) continue;
        least_miss = miss;
        reply.mesh = std::move(mesh);
    }
    reply.triangles = bounding.triangles;
    reply.regions = bounding.regions;
    reply.mesh.region = fill_regions(reply.mesh.tets, bounding.triangles, bounding.regions);
    keep_meshed(reply, job.hollow);
    return reply;
}

}  // namespace palpate::mesh_tool
