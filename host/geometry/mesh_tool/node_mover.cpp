// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/mesh_tool/node_mover.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <limits>
#include <random>

#include "host/geometry/meshing/dihedral.hpp"

namespace palpate::mesh_tool {

namespace {

constexpr int max_rounds = 20;
constexpr int directions = 24;
constexpr double steps[] = {0.3, 0.1, 0.03};  ///< of the shortest edge at the node
constexpr double max_slide = 0.25;            ///< of the shortest edge, in all, for surface nodes
constexpr double flatness = 0.03;  ///< of squared normals: below, a direction is tangential
constexpr double worthwhile_deg = 0.05;

struct Node {
    std::vector<Index> tets;
    Mat3 normals = Mat3::Zero();  ///< sum over its triangles of area * n n^T
    bool on_surface = false;
    Vec3 start = Vec3::Zero();
};

std::vector<Node> gather(const Mesh& mesh, const std::vector<Triangle>& triangles) {
    std::vector<Node> nodes(mesh.nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n].start = mesh.nodes[n];
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        for (Index n : mesh.tets[t]) nodes[n].tets.push_back(static_cast<Index>(t));
    for (const auto& [a, b, c] : triangles) {
        const Vec3 area = (mesh.nodes[b] - mesh.nodes[a]).cross(mesh.nodes[c] - mesh.nodes[a]);
        const Mat3 part = area * area.transpose() / std::max(area.norm(), 1e-300);
        for (Index n : {a, b, c}) {
            nodes[n].normals += part;
            nodes[n].on_surface = true;
        }
    }
    return nodes;
}

/// The projector on the directions in which a node may move: all, a tangent plane, a line, none.
Mat3 freedom_of(const Node& node, SurfaceNodes surface_nodes) {
    if (!node.on_surface) return Mat3::Identity();
    if (surface_nodes == SurfaceNodes::fixed) return Mat3::Zero();
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(node.normals);
    Mat3 freedom = Mat3::Zero();
    for (int i = 0; i < 3; ++i) {
        const Vec3 axis = eigen.eigenvectors().col(i);
        if (eigen.eigenvalues()[i] < flatness * eigen.eigenvalues()[2])
            freedom += axis * axis.transpose();
    }
    return freedom;
}

/// The smallest dihedral angle of the tets at a node; negative if one is inverted.
double worst_angle(const Mesh& mesh, const Node& node) {
    double worst = 180;
    for (Index t : node.tets) {
        if (!(tet_volume(mesh, t) > 0)) return -1;
        worst = std::min(worst, dihedral_range(mesh, t).min_deg);
    }
    return worst;
}

double shortest_edge(const Mesh& mesh, const Node& node, Index n) {
    double shortest = std::numeric_limits<double>::infinity();
    for (Index t : node.tets)
        for (Index other : mesh.tets[t])
            if (other != n)
                shortest = std::min(shortest, (mesh.nodes[other] - mesh.nodes[n]).norm());
    return shortest;
}

class Mover {
public:
    Mover(Mesh& mesh, const std::vector<Triangle>& triangles, SurfaceNodes surface_nodes)
        : mesh_(mesh), nodes_(gather(mesh, triangles)), surface_nodes_(surface_nodes) {}

    /// Whether a better place was found.
    bool improve(Index n) {
        const Node& node = nodes_[n];
        const Mat3 freedom = freedom_of(node, surface_nodes_);
        if (freedom.isZero()) return false;
        const double edge = shortest_edge(mesh_, node, n);
        double best = worst_angle(mesh_, node);
        bool improved = false;
        for (double step : steps) {
            for (int i = 0; i < directions; ++i) {
                const Vec3 here = mesh_.nodes[n];
                const Vec3 there = here + step * edge * (freedom * random_direction());
                if (node.on_surface && (there - node.start).norm() > max_slide * edge) continue;
                mesh_.nodes[n] = there;
                const double angle = worst_angle(mesh_, node);
                if (angle > best + worthwhile_deg) {
                    best = angle;
                    improved = true;
                } else {
                    mesh_.nodes[n] = here;
                }
            }
        }
        return improved;
    }

private:
    Vec3 random_direction() {
        const auto uniform = [&] { return 2.0 * double(random_()) / double(random_.max()) - 1; };
        return Vec3(uniform(), uniform(), uniform()).normalized();
    }

    Mesh& mesh_;
    std::vector<Node> nodes_;
    SurfaceNodes surface_nodes_;
    std::mt19937 random_{1};
};

}  // namespace

void move_nodes_of_slivers(Mesh& mesh, const std::vector<Triangle>& triangles,
                           SurfaceNodes surface_nodes, double goal_deg) {
    Mover mover(mesh, triangles, surface_nodes);
    for (int round = 0; round < max_rounds; ++round) {
        bool improved = false;
        for (Index t = 0; t < mesh.num_tets(); ++t) {
            if (dihedral_range(mesh, t).min_deg >= goal_deg) continue;
            for (Index n : mesh.tets[t]) improved |= mover.improve(n);
        }
        if (!improved) return;
    }
}

}  // namespace palpate::mesh_tool
