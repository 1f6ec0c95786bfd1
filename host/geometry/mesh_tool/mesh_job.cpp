// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/mesh_tool/mesh_job.hpp"

#include <algorithm>
#include <cmath>

#include "solver/base/error.hpp"

namespace palpate::mesh_tool {

namespace {

[[noreturn]] void malformed(const std::string& what) {
    throw Error(ErrorCode::input_unreadable, "the job of the mesher is malformed: " + what);
}

double positive_number(const Exchange& exchange, const std::string& name) {
    const auto& values = exchange.get<double>(name);
    if (values.size() != 1 || !std::isfinite(values[0]) || values[0] <= 0) malformed(name);
    return values[0];
}

Index positive_count(const Exchange& exchange, const std::string& name) {
    const auto& values = exchange.get<std::int32_t>(name);
    if (values.size() != 1 || values[0] <= 0) malformed(name);
    return values[0];
}

Vec3 one_point(const Exchange& exchange, const std::string& name) {
    const std::vector<Vec3> points = exchange.points(name);
    if (points.size() != 1 || !points[0].allFinite()) malformed(name);
    return points[0];
}

void check_grid(const VolumeJob& job) {
    double samples = static_cast<double>(job.region_numbers.size());
    for (int axis = 0; axis < 3; ++axis) {
        if (job.size[axis] < 2 || job.spacing[axis] <= 0) malformed("the grid");
        if (job.box_high[axis] <= job.box_low[axis]) malformed("the box");
        samples *= job.size[axis];
    }
    if (samples != static_cast<double>(job.values.size())) malformed("the number of values");
    if (job.volumes.size() != job.region_numbers.size()) malformed("the number of volumes");
    if (job.facet_distances.size() != job.region_numbers.size()) malformed("facet_distances");
    for (double distance : job.facet_distances)
        if (!std::isfinite(distance) || distance <= 0) malformed("facet_distances");
    for (Index region : job.region_numbers)
        if (region < 0 || region > 65535) malformed("a region number");
    for (float value : job.values)
        if (!std::isfinite(value)) malformed("a value that is not finite");
}

}  // namespace

SurfaceJob read_surface_job(const Exchange& exchange) {
    SurfaceJob job;
    job.vertices = exchange.points("vertices");
    job.triangles = exchange.rows<3>("triangles");
    job.regions = exchange.rows<2>("regions");
    job.hollow = exchange.get<std::int32_t>("hollow");
    job.num_nodes = positive_count(exchange, "num_nodes");
    job.outer_edge_length_mm = positive_number(exchange, "outer_edge_length_mm");
    job.radius_edge_ratio = positive_number(exchange, "radius_edge_ratio");
    job.min_dihedral_deg = positive_number(exchange, "min_dihedral_deg");
    job.max_dihedral_deg = positive_number(exchange, "max_dihedral_deg");
    return job;
}

VolumeJob read_volume_job(const Exchange& exchange) {
    VolumeJob job;
    const auto size = exchange.rows<3>("grid_size");
    if (size.size() != 1) malformed("grid_size");
    job.size = size[0];
    job.origin = one_point(exchange, "grid_origin");
    job.spacing = one_point(exchange, "grid_spacing");
    job.values = exchange.get<float>("values");
    job.region_numbers = exchange.get<std::int32_t>("region_numbers");
    job.volumes = exchange.get<double>("volumes");
    job.facet_distances = exchange.get<double>("facet_distances");
    job.box_low = one_point(exchange, "box_low");
    job.box_high = one_point(exchange, "box_high");
    job.hollow = exchange.get<std::int32_t>("hollow");
    job.num_nodes = positive_count(exchange, "num_nodes");
    job.edge_length_mm = positive_number(exchange, "edge_length_mm");
    job.outer_edge_length_mm = positive_number(exchange, "outer_edge_length_mm");
    check_grid(job);
    return job;
}

void write_reply(const std::filesystem::path& path, const MeshReply& reply,
                 const std::string& mesher) {
    Exchange exchange;
    exchange.set_text("mesher", mesher);
    exchange.set_points("nodes", reply.mesh.nodes);
    exchange.set_rows("tets", reply.mesh.tets);
    exchange.set("tet_regions", reply.mesh.region);
    exchange.set_rows("triangles", reply.triangles);
    exchange.set_rows("triangle_regions", reply.regions);
    exchange.set("triangle_source", reply.source);
    exchange.write(path);
}

bool is_meshed(Index region, const std::vector<Index>& hollow) {
    return region > 0 && std::find(hollow.begin(), hollow.end(), region) == hollow.end();
}

void turn_to_positive_volume(Mesh& mesh) {
    for (Index t = 0; t < mesh.num_tets(); ++t)
        if (tet_volume(mesh, t) < 0) std::swap(mesh.tets[t][2], mesh.tets[t][3]);
}

void keep_meshed(MeshReply& reply, const std::vector<Index>& hollow) {
    Mesh& mesh = reply.mesh;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        if (!is_meshed(mesh.region[t], hollow)) continue;
        mesh.region[kept] = mesh.region[t];
        mesh.tets[kept] = mesh.tets[t];
        ++kept;
    }
    mesh.tets.resize(kept);
    mesh.region.resize(kept);

    std::vector<Index> number(mesh.nodes.size(), -1);
    for (const Tet& tet : mesh.tets)
        for (Index node : tet) number[node] = 0;
    Index count = 0;
    for (std::size_t n = 0; n < number.size(); ++n) {
        if (number[n] < 0) continue;
        mesh.nodes[count] = mesh.nodes[n];
        number[n] = count++;
    }
    mesh.nodes.resize(count);
    for (Tet& tet : mesh.tets)
        for (Index& node : tet) node = number[node];

    kept = 0;
    for (std::size_t i = 0; i < reply.triangles.size(); ++i) {
        const auto& sides = reply.regions[i];
        if (!is_meshed(sides[0], hollow) && !is_meshed(sides[1], hollow)) continue;
        for (int k = 0; k < 3; ++k) reply.triangles[kept][k] = number[reply.triangles[i][k]];
        reply.regions[kept] = sides;
        if (!reply.source.empty()) reply.source[kept] = reply.source[i];
        ++kept;
    }
    reply.triangles.resize(kept);
    reply.regions.resize(kept);
    if (!reply.source.empty()) reply.source.resize(kept);
}

}  // namespace palpate::mesh_tool
