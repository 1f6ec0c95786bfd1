// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "solver/model/surface_load.hpp"

namespace palpate {

enum class ObstacleShape { plane, cylinder, sphere, tube, punch };
/// "plane", "cylinder", "sphere", "tube", "punch".
const char* name_of(ObstacleShape shape);
/// Throws Error(invalid_argument) naming those that there are.
ObstacleShape obstacle_shape_of(const std::string& name);
/// Whether it has a flat end with a rounded edge: tube and punch.
bool has_edge(ObstacleShape shape);

/// A rigid body. A punch is a cylinder with a flat end whose edge is rounded; a tube has a flat rim
/// from radius + edge radius to outer radius - outer edge radius, both edges rounded, a bore and an
/// outer side. Both go back from their end without end. In plane strain and plane stress a cylinder
/// stands across the plane and a sphere is a circle, too, a tube is a slot between two jaws and a
/// punch a strip; about an axis the shape is drawn in the half-plane and turned with it: a plane is
/// a cone unless its normal runs along the axis, a sphere off the axis is a ring, tube and punch
/// stand on the axis.
struct Obstacle {
    ObstacleShape shape = ObstacleShape::plane;
    /// A point of the plane, of the cylinder's axis; a centre, also of a tube's or punch's end. mm
    Vec3 place = Vec3::Zero();
    /// Of any length: the outward normal of a plane or of an end, or an axis.
    Vec3 direction = Vec3::UnitZ();
    double radius_mm = 1;        ///< of cylinder, sphere and punch; of a tube's hole
    bool is_hollow = false;      ///< the solid lies inside the cylinder or sphere, not around it
    double edge_radius_mm = 0;   ///< of a punch's edge; of that between rim and bore
    double outer_radius_mm = 0;  ///< of a tube's outer side
    double outer_edge_radius_mm = 0;  ///< of the edge between rim and outer side
};

/// The lengths that shape an obstacle, in the order of derivatives by them.
inline constexpr std::array obstacle_sizes{"radius_mm", "edge_radius_mm", "outer_radius_mm",
                                           "outer_edge_radius_mm"};

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
/// direction without length, a radius, stiffness or friction out of range, a rim or an end too
/// narrow for its edges, faces that are none, a direction that leaves the plane of a plane mesh, a
/// tube or punch beside the axis.
void check_contact(const Contact& contact, const SolidMesh& mesh);

}  // namespace palpate
