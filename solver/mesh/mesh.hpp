// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Linear tetrahedra. Nodes in mm (LPS patient space); every tet has positive volume with the
/// ordering (p1 - p0) . ((p2 - p0) x (p3 - p0)) > 0. `region` holds one number per tet, which
/// indexes the materials of a `Model`.
struct Mesh {
    std::vector<Vec3> nodes;    ///< [num_nodes], mm
    std::vector<Tet> tets;      ///< [num_tets], node numbers
    std::vector<Index> region;  ///< [num_tets]

    Index num_nodes() const { return static_cast<Index>(nodes.size()); }
    Index num_tets() const { return static_cast<Index>(tets.size()); }
};

/// Signed volume of a tetrahedron, mm^3.
inline double tet_volume(const Vec3& p0, const Vec3& p1, const Vec3& p2, const Vec3& p3) {
    return (p1 - p0).dot((p2 - p0).cross(p3 - p0)) / 6.0;
}

inline double tet_volume(const Mesh& mesh, Index tet) {
    const Tet& t = mesh.tets[tet];
    return tet_volume(mesh.nodes[t[0]], mesh.nodes[t[1]], mesh.nodes[t[2]], mesh.nodes[t[3]]);
}

}  // namespace palpate
