// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "solver/model/surface_load.hpp"

namespace palpate {

enum class ObstacleShape { plane, cylinder, sphere };
/// "plane", "cylinder", "sphere".
const char* name_of(ObstacleShape shape);
/// Throws Error(invalid_argument) naming those that there are.
ObstacleShape obstacle_shape_of(const std::string& name);

/// A rigid body. In plane strain and plane stress a cylinder stands across the plane and a sphere
/// is a circle, too; about an axis the shape is drawn in the half-plane and turned with it: a plane
/// is a cone unless its normal runs along the axis, a sphere off the axis is a ring.
struct Obstacle {
    ObstacleShape shape = ObstacleShape::plane;
    Vec3 place = Vec3::Zero();       ///< a point of the plane, of the cylinder's axis; a centre. mm
    Vec3 direction = Vec3::UnitZ();  ///< of any length: the plane's outward normal, or an axis
    double radius_mm = 1;            ///< of cylinder and sphere
    bool is_hollow = false;  ///< the solid lies inside the cylinder or sphere, not around it
};

/// An obstacle and the part of the surface that may touch it. Depth g of a surface point inside the
/// obstacle gives a pressure stiffness g on the undeformed area, against which Coulomb's friction
/// holds with `slip_stiffness` up to friction times the pressure.
struct Contact {
    Obstacle obstacle;
    std::vector<Face> faces;
    double stiffness_kpa_per_mm = 0;       ///< > 0; a hundred times modulus / element size is stiff
    double slip_stiffness_kpa_per_mm = 0;  ///< > 0 where there is friction
    double friction = 0;                   ///< Coulomb's coefficient, >= 0
};

/// Throws Error(invalid_argument) naming the first broken rule: numbers that are not finite, a
/// direction without length, a radius, stiffness or friction out of range, faces that are none, a
/// direction that leaves the plane of a plane mesh.
void check_contact(const Contact& contact, const SolidMesh& mesh);

}  // namespace palpate
