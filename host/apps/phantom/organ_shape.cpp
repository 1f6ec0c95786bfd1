// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/organ_shape.hpp"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

/// Direction of the gradient of `value`, by central differences over `h` to both sides.
Vec3 gradient_direction(const OrganShape& shape, const Vec3& x, double h) {
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 e = h * Vec3::Unit(axis);
        gradient[axis] = shape.value(x + e) - shape.value(x - e);
    }
    return gradient.normalized();
}

/// The larger of two numbers, rounded off where they differ by less than 3 mm.
double smooth_maximum(double a, double b) {
    constexpr double width_mm = 3;
    const double t = std::clamp(0.5 + 0.5 * (b - a) / width_mm, 0.0, 1.0);
    return (1 - t) * a + t * b + width_mm * t * (1 - t);
}

/// The points which, shifted, lie within `distance` of the bounding box of `others`.
std::vector<Vec3> points_near(const std::vector<Vec3>& points, const Vec3& shift,
                              const std::vector<Vec3>& others, double distance) {
    Vec3 low = others.front(), high = others.front();
    for (const Vec3& y : others) {
        low = low.cwiseMin(y);
        high = high.cwiseMax(y);
    }
    std::vector<Vec3> near;
    for (const Vec3& x : points) {
        const Vec3 y = x + shift;
        const bool is_near =
            ((y - low).array() >= -distance).all() && ((y - high).array() <= distance).all();
        if (is_near) near.push_back(x);
    }
    return near;
}

}  // namespace

SmoothField::SmoothField(RandomNumbers& random, double shortest_mm, double longest_mm) {
    constexpr int num_waves = 4;
    constexpr double two_pi = 6.283185307179586;
    for (int n = 0; n < num_waves; ++n) {
        const double length = random.uniform(shortest_mm, longest_mm);
        const Vec3 wave_vector = two_pi / length * random.direction();
        waves_.push_back({wave_vector, random.uniform(0, two_pi), 0.5});
    }
}

double SmoothField::operator()(const Vec3& x) const {
    double sum = 0;
    for (const Wave& wave : waves_) {
        sum += wave.amplitude * std::sin(wave.wave_vector.dot(x) + wave.phase);
    }
    return sum;
}

double OrganShape::undented_value(const Vec3& x) const {
    Vec3 q = axes.transpose() * (x - centre);
    if (warp_mm > 0) q += warp_mm * Vec3(warp[0](q), warp[1](q), warp[2](q));
    const double along = std::clamp(q[2] / semi_axes[2], -1.5, 1.5);
    q[1] -= bend_mm * along * along;
    q.head<2>() /= 1 + taper * along;

    // k0 = (rho^e + |z/c|^e)^(1/e) is 1 on the surface; (k0 - 1) / |grad k0| is about the distance.
    const double rho = std::hypot(q[0] / semi_axes[0], q[1] / semi_axes[1]);
    const double height = std::abs(q[2]) / semi_axes[2], e = roundness;
    const double k0 = std::pow(std::pow(rho, e) + std::pow(height, e), 1 / e);
    if (k0 < 0.1) return -semi_axes.minCoeff();
    const double d_rho = std::pow(rho / k0, e - 1), d_height = std::pow(height / k0, e - 1);
    const double rho_slope = rho > 0 ? std::hypot(q[0] / (semi_axes[0] * semi_axes[0]),
                                                  q[1] / (semi_axes[1] * semi_axes[1])) /
                                           rho
                                     : 0.0;
    return (k0 - 1) / std::hypot(d_rho * rho_slope, d_height / semi_axes[2]);
}

double OrganShape::value(const Vec3& x) const {
    const double own = undented_value(x);
    return dented_by ? smooth_maximum(own, dent_gap_mm - dented_by->value(x)) : own;
}

Vec3 OrganShape::normal(const Vec3& x) const { return gradient_direction(*this, x, 0.05); }

Vec3 OrganShape::smooth_normal(const Vec3& x) const { return gradient_direction(*this, x, 5.0); }

double OrganShape::reach() const {
    return 1.1 * semi_axes.maxCoeff() * (1 + std::abs(taper)) + std::abs(bend_mm) + 2 * warp_mm + 2;
}

std::vector<Vec3> surface_points(const OrganShape& shape, int num_points) {
    constexpr double golden_angle = 2.399963229728653;
    constexpr int num_bisections = 14;
    std::vector<Vec3> points(num_points);
    for (int n = 0; n < num_points; ++n) {
        const double z = 1 - (2 * n + 1.0) / num_points, radius = std::sqrt(1 - z * z);
        const Vec3 ray(radius * std::cos(n * golden_angle), radius * std::sin(n * golden_angle), z);
        double inside = 0, outside = shape.reach();
        for (int b = 0; b < num_bisections; ++b) {
            const double middle = 0.5 * (inside + outside);
            (shape.value(shape.centre + middle * ray) < 0 ? inside : outside) = middle;
        }
        points[n] = outside * ray;
    }
    return points;
}

double gap_between(const OrganShape& a, const std::vector<Vec3>& points_a, const OrganShape& b,
                   const std::vector<Vec3>& points_b) {
    const Vec3 offset = a.centre - b.centre;  // everything below is relative to the centre of b
    double depth = 0;
    for (const Vec3& x : points_a) depth = std::min(depth, b.value(a.centre + x));
    if (depth < 0) return depth;

    double smallest = std::numeric_limits<double>::max();
    const auto visit_pairs = [&](const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                                 std::size_t stride) {
        for (std::size_t n = 0; n < from.size(); n += stride) {
            const Vec3 x = from[n] + offset;
            for (std::size_t m = 0; m < to.size(); m += stride) {
                smallest = std::min(smallest, (x - to[m]).squaredNorm());
            }
        }
    };
    visit_pairs(points_a, points_b, 10);  // a bound; then only pairs that can be closer
    const double bound = std::sqrt(smallest);
    visit_pairs(points_near(points_a, offset, points_b, bound),
                points_near(points_b, -offset, points_a, bound), 1);
    return std::sqrt(smallest);
}

}  // namespace palpate
