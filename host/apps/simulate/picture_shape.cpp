// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/picture_shape.hpp"

#include <map>
#include <span>

#include "solver/model/surface_load.hpp"

namespace palpate {
namespace {

/// Corners and middles in the order of the rim.
std::vector<Index> rim_of(std::span<const Index> nodes, int num_corners) {
    std::vector<Index> rim;
    const bool has_middles = static_cast<int>(nodes.size()) == 2 * num_corners;
    for (int a = 0; a < num_corners; ++a) {
        rim.push_back(nodes[a]);
        if (has_middles) rim.push_back(nodes[num_corners + a]);
    }
    return rim;
}

/// Cuts tetrahedra; a point on an edge is shared by all that have the edge.
class Cutter {
public:
    Cutter(const SolidMesh& mesh, double y_mm, PictureShape& shape)
        : mesh_(mesh), y_mm_(y_mm), shape_(shape) {}

    void cut(std::span<const Index> tet) {
        std::vector<Index> before, behind;
        for (int a = 0; a < 4; ++a) (depth(tet[a]) < 0 ? before : behind).push_back(tet[a]);
        if (before.empty() || behind.empty()) return;
        if (before.size() > behind.size()) std::swap(before, behind);
        if (before.size() == 1) {
            shape_.patches.push_back({point(before[0], behind[0]), point(before[0], behind[1]),
                                      point(before[0], behind[2])});
        } else {
            shape_.patches.push_back({point(before[0], behind[0]), point(before[0], behind[1]),
                                      point(before[1], behind[1]), point(before[1], behind[0])});
        }
    }

private:
    double depth(Index node) const { return mesh_.nodes[node].y() - y_mm_; }
    Index point(Index a, Index b) {
        const std::pair<Index, Index> edge = std::minmax(a, b);
        const auto [found, is_new] =
            number_.try_emplace(edge, static_cast<Index>(shape_.points.size()));
        if (is_new) {
            const double from = depth(edge.first), to = depth(edge.second);
            shape_.points.push_back({edge.first, edge.second, from / (from - to)});
        }
        return found->second;
    }

    const SolidMesh& mesh_;
    double y_mm_;
    PictureShape& shape_;
    std::map<std::pair<Index, Index>, Index> number_;
};

}  // namespace

PictureShape body_shape(const SolidMesh& mesh) {
    PictureShape shape;
    shape.view = PictureView::of(mesh.formulation);
    shape.is_closed = mesh.formulation == Formulation::solid;
    shape.is_mirrored = mesh.formulation == Formulation::axisymmetric;
    for (Index n = 0; n < mesh.num_nodes(); ++n) shape.points.push_back({n, n, 0});
    if (shape.is_closed) {
        for (const Face& face : boundary_faces(mesh)) shape.patches.push_back(rim_of(face, 3));
    } else {
        for (Index e = 0; e < mesh.num_elements(); ++e)
            shape.patches.push_back(rim_of(mesh.nodes_of(e), mesh.table().num_corners));
    }
    return shape;
}

PictureShape section_shape(const SolidMesh& mesh, double y_mm) {
    PictureShape shape;
    shape.view = {Vec3::UnitX(), Vec3::UnitZ(), -Vec3::UnitY()};
    Cutter cutter(mesh, y_mm, shape);
    for (Index e = 0; e < mesh.num_elements(); ++e) cutter.cut(mesh.nodes_of(e));
    return shape;
}

}  // namespace palpate
