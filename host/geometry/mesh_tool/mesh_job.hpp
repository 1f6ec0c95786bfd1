// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/geometry/meshing/exchange.hpp"
#include "solver/base/types.hpp"
#include "solver/mesh/mesh.hpp"

namespace palpate::mesh_tool {

/// What the parent asks of the surface mesher. `regions[i]` lies behind and in front of triangle i.
struct SurfaceJob {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    std::vector<std::array<Index, 2>> regions;
    std::vector<Index> hollow;  ///< regions without tets; region 0 (outside) always is
    Index num_nodes = 0;        ///< wanted
    double outer_edge_length_mm = 0;
    double radius_edge_ratio = 1.4;
    double min_dihedral_deg = 15;   ///< aimed at, not promised
    double max_dihedral_deg = 140;  ///< above it, a tet is improved by flips and smoothing
};

/// What the parent asks of the volume mesher: the value of each region's field on a regular grid in
/// a frame where the image box is axis-aligned; the region at a point is the one of least value.
struct VolumeJob {
    std::array<Index, 3> size{0, 0, 0};
    Vec3 origin = Vec3::Zero();
    Vec3 spacing = Vec3::Ones();
    std::vector<float> values;            ///< [num_samples * num_regions], i fastest, regions inner
    std::vector<Index> region_numbers;    ///< [num_regions]
    std::vector<double> volumes;          ///< [num_regions] wanted, mm^3
    std::vector<double> facet_distances;  ///< [num_regions] between facets and interface, mm
    Vec3 box_low = Vec3::Zero(), box_high = Vec3::Zero();
    std::vector<Index> hollow;
    Index num_nodes = 0;
    double edge_length_mm = 0, outer_edge_length_mm = 0;
};

/// A mesh without unused nodes. Triangles are the interfaces with a meshed region on at least one
/// side, their normal points from regions[0] to regions[1].
struct MeshReply {
    Mesh mesh;
    std::vector<Triangle> triangles;
    std::vector<std::array<Index, 2>> regions;
    std::vector<Index> source;  ///< surface mesher: number of the triangle given, else empty
};

/// Throw Error(input_unreadable) for a job that is malformed, Error(mesh_failed) for one that
/// cannot be meshed.
SurfaceJob read_surface_job(const Exchange& exchange);
VolumeJob read_volume_job(const Exchange& exchange);
void write_reply(const std::filesystem::path& path, const MeshReply& reply,
                 const std::string& mesher);

std::string tetgen_name();  ///< with its version; empty if this build has no TetGen
std::string cgal_name();
MeshReply mesh_with_tetgen(const SurfaceJob& job);
MeshReply mesh_with_cgal(const VolumeJob& job);

bool is_meshed(Index region, const std::vector<Index>& hollow);

/// Swaps two nodes of every tet of negative volume.
void turn_to_positive_volume(Mesh& mesh);

/// Drops tets of unmeshed regions, triangles between two of them and nodes that are no longer used.
/// Nodes keep their order.
void keep_meshed(MeshReply& reply, const std::vector<Index>& hollow);

}  // namespace palpate::mesh_tool
