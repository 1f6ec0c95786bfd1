// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// Nodes of one face as `ElementTable::faces` orders them: a triangle of 3 or 6 nodes, or in a
/// plane an edge of 2 or 3.
using Face = std::vector<Index>;

/// The faces that belong to one element only, in the order of elements, all of whose nodes satisfy
/// `is_wanted`; without it all of them.
std::vector<Face> boundary_faces(const SolidMesh& mesh,
                                 const std::function<bool(Index node)>& is_wanted = {});

/// A quadrature point of an undeformed face.
struct FacePoint {
    std::array<double, 6> value{};  ///< shape functions of the face's nodes
    Vec3 place = Vec3::Zero();      ///< mm
    Vec3 normal = Vec3::Zero();     ///< outward, of length 1
    double area =
        0;  ///< mm^2; about an axis of the whole circumference, in a plane of the thickness
};

/// The points of a face of `boundary_faces`: three, for linear and quadratic faces alike.
std::vector<FacePoint> face_points(const SolidMesh& mesh, const Face& face);

/// Traction (kPa) at a place (mm) of the undeformed surface with this outward unit normal.
using Traction = std::function<Vec3(const Vec3& place, const Vec3& normal)>;

/// The nodal forces [3 num_nodes] mN that do the same work as the traction on the undeformed faces;
/// about an axis over the whole circumference, in a plane over the thickness.
Eigen::VectorXd traction_forces(const SolidMesh& mesh, const std::vector<Face>& faces,
                                const Traction& traction);

}  // namespace palpate
