// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/contact.hpp"

#include <cmath>

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
    const bool is_plane = obstacle.shape == ObstacleShape::plane;
    const double across = std::abs(obstacle.direction.normalized().z());
    if (is_plane && across > 0)
        refuse_obstacle("of a plane mesh is a plane whose normal leaves it");
    if (!is_plane && across < 1)
        refuse_obstacle(
            "of a plane mesh is a cylinder that does not stand across it: its direction is z");
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
    }
    return "";
}

ObstacleShape obstacle_shape_of(const std::string& name) {
    for (const auto shape : {ObstacleShape::plane, ObstacleShape::cylinder, ObstacleShape::sphere})
        if (name == name_of(shape)) return shape;
    refuse_obstacle("cannot be a '" + name + "'; there are plane, cylinder, sphere");
}

void check_contact(const Contact& contact, const SolidMesh& mesh) {
    const Obstacle& obstacle = contact.obstacle;
    if (!obstacle.place.allFinite() || !obstacle.direction.allFinite())
        refuse_obstacle("has a place or a direction that is not a finite number");
    check_direction(obstacle, mesh.formulation);
    const bool is_round = obstacle.shape != ObstacleShape::plane;
    if (is_round && !(obstacle.radius_mm > 0 && std::isfinite(obstacle.radius_mm)))
        refuse_obstacle("needs a radius greater than 0 mm");
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
