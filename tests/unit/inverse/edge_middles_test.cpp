// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/observations/edge_middles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace palpate {
namespace {

constexpr int num_sides = 9;
constexpr double edge_mm = 4;

using Field = std::function<double(const Vec3& x)>;

/// A sheet of triangles of 4 mm, its inner vertices moved by up to `jitter_mm`.
Surface sheet(double jitter_mm, const Field& height) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> offset(-jitter_mm, jitter_mm);
    Surface surface;
    for (int j = 0; j < num_sides; ++j)
        for (int i = 0; i < num_sides; ++i) {
            Vec3 x(edge_mm * (i + 0.5 * (j % 2)), edge_mm * std::sqrt(0.75) * j, 0);
            x += Vec3(offset(engine), offset(engine), 0);
            x[2] = height(x);
            surface.vertices.push_back(x);
        }
    for (int j = 0; j + 1 < num_sides; ++j)
        for (int i = 0; i + 1 < num_sides; ++i) {
            const Index p = j * num_sides + i, q = p + 1, r = p + num_sides, s = r + 1;
            if (j % 2 == 0) {
                surface.triangles.push_back({p, q, r});
                surface.triangles.push_back({q, s, r});
            } else {
                surface.triangles.push_back({p, q, s});
                surface.triangles.push_back({p, s, r});
            }
        }
    return surface;
}

bool is_inner(Index vertex) {
    const Index i = vertex % num_sides, j = vertex / num_sides;
    return i > 1 && j > 1 && i < num_sides - 2 && j < num_sides - 2;
}

struct Errors {
    double smooth = 0, linear = 0;  ///< largest of inner edges
};

Errors errors_of(const Surface& surface, const Field& u) {
    const EdgeMiddles middles(surface, vertex_normals(surface));
    Errors largest;
    for (const Triangle& triangle : surface.triangles)
        for (int c = 0; c < 3; ++c) {
            const Index p = triangle[c], q = triangle[(c + 1) % 3];
            if (!is_inner(p) || !is_inner(q)) continue;
            double at_middle = 0, sum = 0;
            for (const auto& [vertex, weight] : middles.at(p, q)) {
                at_middle += weight * u(surface.vertices[vertex]);
                sum += weight;
            }
            EXPECT_NEAR(sum, 1, 1e-12);
            const double truth = u(0.5 * (surface.vertices[p] + surface.vertices[q]));
            const double mean = 0.5 * (u(surface.vertices[p]) + u(surface.vertices[q]));
            largest.smooth = std::max(largest.smooth, std::abs(at_middle - truth));
            largest.linear = std::max(largest.linear, std::abs(mean - truth));
        }
    return largest;
}

double flat(const Vec3&) { return 0; }
double linear(const Vec3& x) { return 1 + 0.3 * x[0] - 0.2 * x[1]; }
double quadratic(const Vec3& x) { return 0.01 * x[0] * x[0] - 0.02 * x[0] * x[1] + 0.01 * x[1]; }
/// 5 mm along some 15 mm.
double bump(const Vec3& x) { return 5 * std::exp(-(x - Vec3(16, 14, 0)).squaredNorm() / 225); }

TEST(EdgeMiddles, AreExactForWhatIsLinearAndOnEvenSurfacesQuadratic) {
    for (const double jitter : {0.0, 0.8})
        EXPECT_LT(errors_of(sheet(jitter, flat), linear).smooth, 1e-12);
    EXPECT_LT(errors_of(sheet(0, flat), quadratic).smooth, 1e-12);
    EXPECT_GT(errors_of(sheet(0, flat), quadratic).linear, 0.02);
}

TEST(EdgeMiddles, FollowABumpBetweenVertices) {
    const auto dome = [](const Vec3& x) { return -(x - Vec3(16, 14, 0)).squaredNorm() / 60; };
    const Errors even = errors_of(sheet(0, flat), bump), uneven = errors_of(sheet(0.8, flat), bump),
                 round = errors_of(sheet(0.8, dome),
                                   [](const Vec3&x) { return bump(Vec3(x[0], x[1], 0)); });
    EXPECT_GT(even.linear, 0.04);
    EXPECT_LT(even.smooth, 0.15 * even.linear);
    EXPECT_LT(uneven.smooth, 0.6 * uneven.linear);
    EXPECT_LT(round.smooth, 0.6 * round.linear);
}

TEST(EdgeMiddles, AreTheMeanOfBothEndsWhereTheSurfaceIsBent) {
    const auto ridge = [](const Vec3& x) { return -3 * std::abs(x[0] - 16); };
    const Surface surface = sheet(0, ridge);
    const EdgeMiddles middles(surface, vertex_normals(surface));
    for (const Triangle& triangle : surface.triangles)
        for (int c = 0; c < 3; ++c) {
            const Index p = triangle[c], q = triangle[(c + 1) % 3];
            if (surface.vertices[p][0] != 16 || surface.vertices[q][0] == 16) continue;
            const auto weights = middles.at(p, q);
            ASSERT_EQ(weights.size(), 2u);
            EXPECT_EQ(weights[0].weight, 0.5);
        }
}

}  // namespace
}  // namespace palpate
