// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "solver/mesh/mesh.hpp"

namespace palpate {

struct DihedralRange {
    double min_deg = 180, max_deg = 0;
};

/// Smallest and largest of the six dihedral angles of a tet of positive volume. The angle at the
/// edge shared by two faces is pi minus the angle between their outward normals.
inline DihedralRange dihedral_range(const Vec3& p0, const Vec3& p1, const Vec3& p2,
                                    const Vec3& p3) {
    const std::array<Vec3, 4> normal{(p2 - p1).cross(p3 - p1), (p3 - p0).cross(p2 - p0),
                                     (p1 - p0).cross(p3 - p0), (p2 - p0).cross(p1 - p0)};
    DihedralRange range;
    for (int a = 0; a < 4; ++a) {
        for (int b = a + 1; b < 4; ++b) {
            const double angle =
                std::atan2(normal[a].cross(normal[b]).norm(), -normal[a].dot(normal[b])) * 180 /
                std::numbers::pi;
            range.min_deg = std::min(range.min_deg, angle);
            range.max_deg = std::max(range.max_deg, angle);
        }
    }
    return range;
}

inline DihedralRange dihedral_range(const Mesh& mesh, Index tet) {
    const Tet& t = mesh.tets[tet];
    return dihedral_range(mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]], mesh.nodes[t[3]]);
}

}  // namespace palpate
