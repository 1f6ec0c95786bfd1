// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "host/geometry/surfaces/surface.hpp"

namespace palpate::testing {

/// A sphere of `rings` rings of latitude, outward.
inline Surface sphere_surface(const Vec3& centre, double radius, Index rings) {
    const Index sectors = 2 * rings;
    Surface s;
    s.vertices.push_back(centre + Vec3(0, 0, radius));
    for (Index i = 1; i < rings; ++i) {
        for (Index j = 0; j < sectors; ++j) {
            const double theta = M_PI * i / rings, phi = 2 * M_PI * j / sectors;
            s.vertices.push_back(centre + radius * Vec3(std::sin(theta) * std::cos(phi),
                                                        std::sin(theta) * std::sin(phi),
                                                        std::cos(theta)));
        }
    }
    s.vertices.push_back(centre - Vec3(0, 0, radius));
    const Index south = static_cast<Index>(s.vertices.size()) - 1;
    auto at = [&](Index i, Index j) { return 1 + (i - 1) * sectors + j % sectors; };
    for (Index j = 0; j < sectors; ++j) {
        s.triangles.push_back({0, at(1, j), at(1, j + 1)});
        for (Index i = 1; i + 1 < rings; ++i) {
            s.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            s.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
        s.triangles.push_back({south, at(rings - 1, j + 1), at(rings - 1, j)});
    }
    return s;
}

}  // namespace palpate::testing
