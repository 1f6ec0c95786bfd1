// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "solver/model/contact.hpp"

// Where a point is with regard to an obstacle. `Number` is double, or a number that carries its
// derivatives: those of the depth are its gradient, those of the normal its second derivatives.
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

/// The lengths that shape an obstacle, mm; see `Obstacle`.
template <class Number>
struct ObstacleSizes {
    Number radius, edge_radius, outer_radius, outer_edge_radius;

    explicit ObstacleSizes(const Obstacle& obstacle)
        : radius(obstacle.radius_mm),
          edge_radius(obstacle.edge_radius_mm),
          outer_radius(obstacle.outer_radius_mm),
          outer_edge_radius(obstacle.outer_edge_radius_mm) {}
};

template <class Number>
struct ObstacleDepth {
    Number depth;           ///< mm inside the obstacle; negative outside
    Triple<Number> normal;  ///< out of the obstacle, of length 1
};

/// Signed distance from the quarter h <= 0, w <= 0 whose edge is rounded, and its slopes.
template <class Number>
struct EdgeDistance {
    Number distance, by_h, by_w;
};

/// With the radius e of the edge, whose centre is at h = w = -e:
///   d = |(h + e, w + e)| - e   where both h > -e and w > -e,   d = max(h, w)   elsewhere,
/// which is C1 but on h = w <= -e, deeper inside than e.
template <class Number>
EdgeDistance<Number> rounded_edge(const Number& h, const Number& w, const Number& e) {
    using std::sqrt;
    const Number to_h = h + e, to_w = w + e;
    if (to_h > 0 && to_w > 0) {
        const Number from_centre = sqrt(Number(to_h * to_h + to_w * to_w));
        return {Number(from_centre - e), Number(to_h / from_centre), Number(to_w / from_centre)};
    }
    if (h >= w) return {h, Number(1.0), Number(0.0)};
    return {w, Number(0.0), Number(1.0)};
}

/// Of a tube or punch: `along` the axis from the end's plane outward, `across` from the axis.
///   punch   d = rounded(h, r - R, e)
///   tube    d = max(rounded(h, a - r, e), rounded(h, r - R, e')): both are h on the flat rim
template <class Number>
ObstacleDepth<Number> depth_in_ring(const Obstacle& obstacle, const ObstacleSizes<Number>& sizes,
                                    const Number& along, const Triple<Number>& across) {
    using std::sqrt;
    const Number square = dot_of(across, across);
    // On the axis the direction from it has no derivative: there the end is flat, or far away.
    const bool is_on_axis = !(square > 0);
    const Number r = is_on_axis ? Number(0.0) : Number(sqrt(square));
    EdgeDistance<Number> found;
    if (obstacle.shape == ObstacleShape::punch) {
        found = rounded_edge<Number>(along, Number(r - sizes.radius), sizes.edge_radius);
    } else {
        found =
            rounded_edge<Number>(along, Number(r - sizes.outer_radius), sizes.outer_edge_radius);
        EdgeDistance<Number> inner =
            rounded_edge<Number>(along, Number(sizes.radius - r), sizes.edge_radius);
        inner.by_w = -inner.by_w;
        if (inner.distance > found.distance) found = inner;
    }
    const Vec3 axis = obstacle.direction.normalized();
    ObstacleDepth<Number> result;
    result.depth = -found.distance;
    for (int i = 0; i < 3; ++i) {
        // n = dd/dh axis + dd/dr e_r
        result.normal[i] = found.by_h * axis[i];
        if (!is_on_axis) result.normal[i] += found.by_w * across[i] / r;
    }
    return result;
}

/// y: the point, in the frame that moves with the obstacle, mm.
template <class Number>
ObstacleDepth<Number> depth_in(const Obstacle& obstacle, const ObstacleSizes<Number>& sizes,
                               const Triple<Number>& y) {
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
    if (obstacle.shape != ObstacleShape::sphere)
        for (int i = 0; i < 3; ++i) from[i] -= along * direction[i];
    if (has_edge(obstacle.shape)) return depth_in_ring(obstacle, sizes, along, from);
    const Number distance = sqrt(dot_of(from, from));
    const double side = obstacle.is_hollow ? -1 : 1;
    result.depth = side * (sizes.radius - distance);
    for (int i = 0; i < 3; ++i) result.normal[i] = side * from[i] / distance;
    return result;
}
template <class Number>
ObstacleDepth<Number> depth_in(const Obstacle& obstacle, const Triple<Number>& y) {
    return depth_in(obstacle, ObstacleSizes<Number>(obstacle), y);
}

}  // namespace palpate
