// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "solver/model/obstacle_depth.hpp"

// What a rigid obstacle does to one point of a surface. `Number` is double, or a number that
// carries its derivatives.
namespace palpate {

/// Penalties of an obstacle: pressure per depth and friction per slip, kPa/mm.
template <class Number>
struct ContactPenalties {
    Number stiffness, slip_stiffness;

    explicit ContactPenalties(const Contact& contact)
        : stiffness(contact.stiffness_kpa_per_mm),
          slip_stiffness(contact.slip_stiffness_kpa_per_mm) {}
};

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
///   sizes          of the obstacle, and its penalties, where they are variables
///   held_limit     takes the place of friction p: then both parts together are a gradient, and
///                  their derivative by y is symmetric
template <class Number>
ContactTraction<Number> contact_traction(const Contact& contact, const ObstacleSizes<Number>& sizes,
                                         const ContactPenalties<Number>& penalties,
                                         const Triple<Number>& y, const Triple<Number>& y_before,
                                         const Triple<Number>& friction_before,
                                         std::optional<double> held_limit) {
    using std::sqrt;
    ContactTraction<Number> result;
    result.pressure.fill(Number(0.0));
    result.friction.fill(Number(0.0));
    const ObstacleDepth<Number> now = depth_in(contact.obstacle, sizes, y);
    Number pressure(0.0);
    if (now.depth > 0) pressure = penalties.stiffness * now.depth;
    for (int i = 0; i < 3; ++i) result.pressure[i] = pressure * now.normal[i];
    result.limit = contact.friction * pressure;
    if (held_limit) result.limit = Number(*held_limit);
    if (!(result.limit > 0)) return result;
    const Triple<Number> normal = depth_in(contact.obstacle, sizes, y_before).normal;
    Triple<Number> z;
    for (int i = 0; i < 3; ++i)
        z[i] = friction_before[i] - penalties.slip_stiffness * (y[i] - y_before[i]);
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

template <class Number>
ContactTraction<Number> contact_traction(const Contact& contact, const Triple<Number>& y,
                                         const Triple<Number>& y_before,
                                         const Triple<Number>& friction_before,
                                         std::optional<double> held_limit) {
    return contact_traction(contact, ObstacleSizes<Number>(contact.obstacle),
                            ContactPenalties<Number>(contact), y, y_before, friction_before,
                            held_limit);
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
