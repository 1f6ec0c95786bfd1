// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/contact.hpp"

#include <cmath>
#include <sstream>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuse_obstacle(const std::string& why) {
    throw Error(ErrorCode::invalid_argument, "an obstacle " + why);
}

void check_direction(const Obstacle& obstacle, Formulation formulation) {
    if (obstacle.shape == ObstacleShape::sphere) return;
    if (!(obstacle.direction.norm() > 0)) refuse_obstacle("needs a direction that is not zero");
    if (formulation == Formulation::solid) return;
    const Vec3 direction = obstacle.direction.normalized();
    const double across = std::abs(direction.z());
    if (obstacle.shape == ObstacleShape::plane && across > 0)
        refuse_obstacle("of a plane mesh is a plane whose normal leaves it");
    if (obstacle.shape == ObstacleShape::cylinder && across < 1)
        refuse_obstacle(
            "of a plane mesh is a cylinder that does not stand across it: its direction is z");
    if (!has_edge(obstacle.shape)) return;
    const std::string kind = name_of(obstacle.shape);
    if (across > 0)
        refuse_obstacle("of a plane mesh is a " + kind + " whose axis leaves it: z must be 0");
    const bool is_on_axis = direction.x() == 0 && obstacle.place.x() == 0;
    if (formulation == Formulation::axisymmetric && !is_on_axis)
        refuse_obstacle("of a mesh about an axis is a " + kind +
                        " that does not stand on it: place and direction need x = 0");
}

std::string millimetres(double value) {
    std::ostringstream text;
    text << value << " mm";
    return text.str();
}

void check_sizes(const Obstacle& obstacle) {
    const auto require = [](double size, const std::string& what) {
        if (!(size > 0 && std::isfinite(size)))
            refuse_obstacle("needs " + what + " greater than 0 mm");
    };
    if (obstacle.shape == ObstacleShape::plane) return;
    const bool is_tube = obstacle.shape == ObstacleShape::tube;
    require(obstacle.radius_mm, is_tube ? "a hole with a radius" : "a radius");
    if (!has_edge(obstacle.shape)) return;
    require(obstacle.edge_radius_mm, "an edge radius");
    if (!is_tube) {
        if (obstacle.edge_radius_mm > obstacle.radius_mm)
            refuse_obstacle("is a punch of radius " + millimetres(obstacle.radius_mm) +
                            ", which is narrower than its edge of radius " +
                            millimetres(obstacle.edge_radius_mm));
        return;
    }
    require(obstacle.outer_radius_mm, "an outer radius");
    require(obstacle.outer_edge_radius_mm, "an outer edge radius");
    const double rim = obstacle.outer_radius_mm - obstacle.radius_mm;
    const double edges = obstacle.edge_radius_mm + obstacle.outer_edge_radius_mm;
    if (!(rim >= edges))
        refuse_obstacle("is a tube whose rim of " + millimetres(rim) +
                        " is narrower than its two edges, " + millimetres(edges) +
                        "; make the outer radius larger or the edges smaller");
}

}  // namespace

const char* name_of(ObstacleShape shape) {
    switch (shape) {
        case ObstacleShape::plane:
            return "plane";
        case ObstacleShape::cylinder:
            return "cylinder";
        case ObstacleShape::sphere:
            return "sphere";
        case ObstacleShape::tube:
            return "tube";
        case ObstacleShape::punch:
            return "punch";
    }
    return "";
}

bool has_edge(ObstacleShape shape) {
    return shape == ObstacleShape::tube || shape == ObstacleShape::punch;
}

ObstacleShape obstacle_shape_of(const std::string& name) {
    for (const auto shape : {ObstacleShape::plane, ObstacleShape::cylinder, ObstacleShape::sphere,
                             ObstacleShape::tube, ObstacleShape::punch})
        if (name == name_of(shape)) return shape;
    refuse_obstacle("cannot be a '" + name + "'; there are plane, cylinder, sphere, tube, punch");
}

void check_contact(const Contact& contact, const SolidMesh& mesh) {
    const Obstacle& obstacle = contact.obstacle;
    if (!obstacle.place.allFinite() || !obstacle.direction.allFinite())
        refuse_obstacle("has a place or a direction that is not a finite number");
    check_direction(obstacle, mesh.formulation);
    check_sizes(obstacle);
    const auto is_stiffness = [](double value) { return value > 0 && std::isfinite(value); };
    if (!is_stiffness(contact.stiffness_kpa_per_mm))
        refuse_obstacle("needs a contact stiffness greater than 0 kPa/mm");
    if (!(contact.friction >= 0 && std::isfinite(contact.friction)))
        refuse_obstacle("needs a coefficient of friction of 0 or more");
    if (contact.friction > 0 && !is_stiffness(contact.slip_stiffness_kpa_per_mm))
        refuse_obstacle("with friction needs a slip stiffness greater than 0 kPa/mm");
    for (const Face& face : contact.faces)
        for (const Index node : face)
            if (node < 0 || node >= mesh.num_nodes())
                refuse_obstacle("may touch a face with node " + std::to_string(node) +
                                "; the mesh has " + std::to_string(mesh.num_nodes()));
}

}  // namespace palpate
