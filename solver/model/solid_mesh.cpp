// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/solid_mesh.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "solver/base/parallel.hpp"
#include "solver/model/refuse.hpp"

namespace palpate {
namespace {

constexpr Index elements_per_thread = 1000;
constexpr std::array formulation_names{"solid", "plane-strain", "plane-stress", "axisymmetric"};

void check_elements(const SolidMesh& mesh) {
    const auto per_element = static_cast<std::size_t>(mesh.table().num_nodes);
    if (mesh.region.empty()) refuse("the mesh has no elements");
    if (mesh.elements.size() != per_element * mesh.region.size()) {
        refuse("a " + mesh.table().name + " mesh needs " + std::to_string(per_element) +
               " node numbers per element; there are " + std::to_string(mesh.elements.size()) +
               " for " + std::to_string(mesh.region.size()) + " elements");
    }
    for (std::size_t k = 0; k < mesh.elements.size(); ++k) {
        if (mesh.elements[k] >= 0 && mesh.elements[k] < mesh.num_nodes()) continue;
        refuse("element " + std::to_string(k / per_element) + " names node " +
               std::to_string(mesh.elements[k]) + " of a mesh of " +
               std::to_string(mesh.num_nodes()) + " nodes");
    }
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        if (mesh.region[e] < 0) {
            refuse("element " + std::to_string(e) + " has the region number " +
                   std::to_string(mesh.region[e]) + "; allowed: 0 and more");
        }
    }
}

void check_nodes(const SolidMesh& mesh) {
    const bool is_plane = mesh.formulation != Formulation::solid;
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        const Vec3& place = mesh.nodes[n];
        const std::string node = "node " + std::to_string(n);
        if (!place.allFinite()) refuse(node + " has no finite place");
        if (is_plane && place.z() != 0) refuse(node + " of a plane mesh is not in the plane z = 0");
        if (mesh.formulation == Formulation::axisymmetric && place.x() < 0) {
            refuse(node + " of an axisymmetric mesh has a negative distance from the axis");
        }
    }
}

/// dX_i / dxi_j at one point; the directions that a plane element lacks are those of the frame.
Mat3 jacobian(const SolidMesh& mesh, Index element, int point) {
    const ElementTable& table = mesh.table();
    const auto nodes = mesh.nodes_of(element);
    Mat3 result = Mat3::Zero();
    for (int a = 0; a < table.num_nodes; ++a)
        for (int j = 0; j < table.dimension; ++j)
            result.col(j) += mesh.nodes[nodes[a]] *
                             table.gradient[(point * table.num_nodes + a) * table.dimension + j];
    for (int j = table.dimension; j < 3; ++j) result(j, j) = 1;
    return result;
}

double radius_at(const SolidMesh& mesh, Index element, int point) {
    const ElementTable& table = mesh.table();
    const auto nodes = mesh.nodes_of(element);
    double radius = 0;
    for (int a = 0; a < table.num_nodes; ++a)
        radius += table.value[point * table.num_nodes + a] * mesh.nodes[nodes[a]].x();
    return radius;
}

PointGeometry geometry_at(const SolidMesh& mesh, Index element, int point) {
    const ElementTable& table = mesh.table();
    const Mat3 mapping = jacobian(mesh, element, point);
    const double size = mapping.determinant();
    if (!(size > 0)) {
        refuse("element " + std::to_string(element) + " is degenerate or turned inside out");
    }
    const Mat3 inverse = mapping.inverse();
    PointGeometry geometry;
    geometry.volume = table.weight[point] * size;
    for (int a = 0; a < table.num_nodes; ++a)
        for (int j = 0; j < table.dimension; ++j) {
            const double slope =
                table.gradient[(point * table.num_nodes + a) * table.dimension + j];
            for (int i = 0; i < 3; ++i) geometry.gradient[a][i] += inverse(j, i) * slope;
        }
    if (mesh.formulation == Formulation::axisymmetric) {
        const double radius = radius_at(mesh, element, point);
        geometry.volume *= 2 * std::numbers::pi * radius;
        for (int a = 0; a < table.num_nodes; ++a)
            geometry.hoop[a] = table.value[point * table.num_nodes + a] / radius;
    } else if (mesh.formulation != Formulation::solid) {
        geometry.volume *= mesh.thickness_mm;
    }
    return geometry;
}

/// The elements of every node, ascending.
Adjacency elements_of_nodes(const SolidMesh& mesh) {
    const auto per_element = static_cast<std::size_t>(mesh.table().num_nodes);
    Adjacency list;
    list.offsets.assign(mesh.nodes.size() + 1, 0);
    for (const Index node : mesh.elements) ++list.offsets[node + 1];
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) list.offsets[n + 1] += list.offsets[n];
    list.items.resize(mesh.elements.size());
    std::vector<Index> next(list.offsets.begin(), list.offsets.end() - 1);
    for (std::size_t k = 0; k < mesh.elements.size(); ++k)
        list.items[next[mesh.elements[k]]++] = static_cast<Index>(k / per_element);
    return list;
}

}  // namespace

const char* name_of(Formulation formulation) {
    return formulation_names[static_cast<std::size_t>(formulation)];
}

Formulation formulation_of(const std::string& name) {
    for (std::size_t k = 0; k < formulation_names.size(); ++k)
        if (name == formulation_names[k]) return static_cast<Formulation>(k);
    refuse("there is no formulation '" + name +
           "'; allowed: solid, plane-strain, plane-stress, axisymmetric");
}

SolidMesh solid_mesh_of(const Mesh& mesh) {
    SolidMesh solid;
    solid.nodes = mesh.nodes;
    solid.region = mesh.region;
    for (const Tet& tet : mesh.tets)
        solid.elements.insert(solid.elements.end(), tet.begin(), tet.end());
    return solid;
}

void check_mesh(const SolidMesh& mesh) {
    const bool is_solid = mesh.formulation == Formulation::solid;
    if ((mesh.table().dimension == 3) != is_solid) {
        refuse("elements of type " + mesh.table().name + " do not go with the formulation " +
               name_of(mesh.formulation));
    }
    if (!(mesh.thickness_mm > 0)) refuse("the thickness of a plane mesh must be greater than 0");
    check_nodes(mesh);
    check_elements(mesh);
}

std::vector<PointGeometry> point_geometry(const SolidMesh& mesh) {
    const int points = mesh.table().num_points;
    std::vector<PointGeometry> geometry(static_cast<std::size_t>(mesh.num_elements()) * points);
    parallel_ranges(mesh.num_elements(), elements_per_thread, [&](Index begin, Index end) {
        for (Index e = begin; e < end; ++e)
            for (int q = 0; q < points; ++q)
                geometry[static_cast<std::size_t>(e) * points + q] = geometry_at(mesh, e, q);
    });
    return geometry;
}

Adjacency node_graph(const SolidMesh& mesh) {
    const Adjacency around = elements_of_nodes(mesh);
    Adjacency graph;
    graph.offsets.push_back(0);
    std::vector<Index> row;
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        row.assign(1, n);
        for (Index k = around.offsets[n]; k < around.offsets[n + 1]; ++k) {
            const auto nodes = mesh.nodes_of(around.items[k]);
            row.insert(row.end(), nodes.begin(), nodes.end());
        }
        std::sort(row.begin(), row.end());
        row.erase(std::unique(row.begin(), row.end()), row.end());
        graph.items.insert(graph.items.end(), row.begin(), row.end());
        graph.offsets.push_back(static_cast<Index>(graph.items.size()));
    }
    return graph;
}

}  // namespace palpate
