// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "solver/model/contact.hpp"

// What a rigid obstacle does to one point of a surface. `Number` is double, or a number that
// carries its derivatives.
namespace palpate {

template <class Number>
using Triple = std::array<Number, 3>;

template <class Number>
Number dot_of(const Triple<Number>& a, const Triple<Number>& b) {
    return Number(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}
template <class Number>
Number along_direction(const Triple<Number>& a, const Vec3& direction) {
    return Number(a[0] * direction[0] + a[1] * direction[1] + a[2] * direction[2]);
}

/// Where a point is with regard to an obstacle.
template <class Number>
struct ObstacleDepth {
    Number depth;           ///< mm inside the obstacle; negative outside
    Triple<Number> normal;  ///< out of the obstacle, of length 1
};

/// y: the point, in the frame that moves with the obstacle, mm.
template <class Number>
ObstacleDepth<Number> depth_in(const Obstacle& obstacle, const Triple<Number>& y) {
    using std::sqrt;
    const Vec3 direction = obstacle.direction.normalized();
    Triple<Number> from;
    for (int i = 0; i < 3; ++i) from[i] = y[i] - obstacle.place[i];
    const Number along = along_direction(from, direction);
    ObstacleDepth<Number> result;
    if (obstacle.shape == ObstacleShape::plane) {
        result.depth = -along;
        for (int i = 0; i < 3; ++i) result.normal[i] = Number(direction[i]);
        return result;
    }
    if (obstacle.shape == ObstacleShape::cylinder)
        for (int i = 0; i < 3; ++i) from[i] -= along * direction[i];
    const Number distance = sqrt(dot_of(from, from));
    const double side = obstacle.is_hollow ? -1 : 1;
    result.depth = side * (obstacle.radius_mm - distance);
    for (int i = 0; i < 3; ++i) result.normal[i] = side * from[i] / distance;
    return result;
}

/// On the body, per undeformed area, kPa.
template <class Number>
struct ContactTraction {
    Triple<Number> pressure;   ///< along the obstacle's normal
    Triple<Number> friction;   ///< across it
    Number limit;              ///< that friction cannot exceed
    bool is_slipping = false;  ///< friction is at its limit
};

/// Coulomb's friction by elastic slip and radial return (Wriggers 2006, section 5.2): with the
/// pressure p = k <depth>, the slip s since the step began and the friction t0 then, both in the
/// plane across the obstacle's normal there,
///   z = t0 - k_t s,   t = z min(1, limit / |z|),   limit = friction p.
///   y, y_before    now and when the step began, in the obstacle's frame, mm
///   held_limit     takes the place of friction p: then both parts together are a gradient, and
///                  their derivative by y is symmetric
template <class Number>
ContactTraction<Number> contact_traction(const Contact& contact, const Triple<Number>& y,
                                         const Triple<Number>& y_before,
                                         const Triple<Number>& friction_before,
                                         std::optional<double> held_limit) {
    using std::sqrt;
    ContactTraction<Number> result;
    result.pressure.fill(Number(0.0));
    result.friction.fill(Number(0.0));
    const ObstacleDepth<Number> now = depth_in(contact.obstacle, y);
    Number pressure(0.0);
    if (now.depth > 0) pressure = contact.stiffness_kpa_per_mm * now.depth;
    for (int i = 0; i < 3; ++i) result.pressure[i] = pressure * now.normal[i];
    result.limit = contact.friction * pressure;
    if (held_limit) result.limit = Number(*held_limit);
    if (!(result.limit > 0)) return result;
    const Triple<Number> normal = depth_in(contact.obstacle, y_before).normal;
    Triple<Number> z;
    for (int i = 0; i < 3; ++i)
        z[i] = friction_before[i] - contact.slip_stiffness_kpa_per_mm * (y[i] - y_before[i]);
    const Number across = dot_of(z, normal);
    for (int i = 0; i < 3; ++i) z[i] -= across * normal[i];
    const Number square = dot_of(z, z);
    result.friction = z;
    if (square > result.limit * result.limit) {
        result.is_slipping = true;
        const Number part = result.limit / sqrt(square);
        for (int i = 0; i < 3; ++i) result.friction[i] = part * z[i];
    }
    return result;
}

/// What `contact_traction` with a held limit is minus the derivative of, by y; kPa mm.
inline double contact_energy(const Contact& contact, const Triple<double>& y,
                             const Triple<double>& y_before, const Triple<double>& friction_before,
                             double held_limit) {
    const double depth = std::max(0.0, depth_in(contact.obstacle, y).depth);
    const double energy = 0.5 * contact.stiffness_kpa_per_mm * depth * depth;
    if (!(held_limit > 0)) return energy;
    const Triple<double> normal = depth_in(contact.obstacle, y_before).normal;
    Triple<double> z;
    for (int i = 0; i < 3; ++i)
        z[i] = friction_before[i] - contact.slip_stiffness_kpa_per_mm * (y[i] - y_before[i]);
    const double across = dot_of(z, normal);
    const double length = std::sqrt(std::max(0.0, dot_of(z, z) - across * across));
    const double beyond = std::max(0.0, length - held_limit);
    return energy + (length * length - beyond * beyond) / (2 * contact.slip_stiffness_kpa_per_mm);
}

}  // namespace palpate
