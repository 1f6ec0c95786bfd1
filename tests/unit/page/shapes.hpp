// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <map>

#include "host/page/surface_view.hpp"

namespace palpate {

/// The surface of the unit cube with n x n squares on each side, vertices shared.
inline TriangleShape box_shape(Index n) {
    TriangleShape box;
    std::map<std::array<Index, 3>, Index> number;
    const auto vertex = [&](std::array<Index, 3> at) {
        const auto [found, is_new] =
            number.try_emplace(at, static_cast<Index>(box.vertices.size()));
        if (is_new) box.vertices.push_back(Vec3(at[0], at[1], at[2]) / n);
        return found->second;
    };
    for (int axis = 0; axis < 3; ++axis)
        for (const Index side : {Index{0}, n})
            for (Index i = 0; i < n; ++i)
                for (Index k = 0; k < n; ++k) {
                    const auto corner = [&](Index di, Index dk) {
                        std::array<Index, 3> at{};
                        at[axis] = side;
                        at[(axis + 1) % 3] = i + di;
                        at[(axis + 2) % 3] = k + dk;
                        return vertex(at);
                    };
                    Index a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
                    if (side == 0) std::swap(b, d);
                    box.triangles.push_back({a, b, c});
                    box.triangles.push_back({a, c, d});
                }
    return box;
}

inline double area_of(const TriangleShape& shape) {
    double area = 0;
    for (const auto& [a, b, c] : shape.triangles) {
        const Vec3 ab = shape.vertices[b] - shape.vertices[a],
                   ac = shape.vertices[c] - shape.vertices[a];
        area += ab.cross(ac).norm() / 2;
    }
    return area;
}

/// A box that is stretched along x, its right end twice as far as its middle, with a temperature.
inline SurfaceView stretched_box_view() {
    SurfaceInView box{.name = "box", .colour = "#d55e00"};
    box.shape = box_shape(4);
    std::vector<Vec3> u;
    std::vector<double> warmth;
    for (const Vec3& x : box.shape.vertices) {
        u.emplace_back(x.x(), 0, 0);
        warmth.push_back(x.z());
    }
    box.displacement = {{}, u};
    box.values = {{}, {{}, warmth}};
    return {.label = "A box",
            .states = {"short", "long"},
            .first = 1,
            .fields = {{.name = "displacement", .unit = "mm", .is_displacement = true},
                       {.name = "warmth", .unit = "K", .ranges = {0.5, 1}, .is_signed = true}},
            .plain_name = "box",
            .outline_name = "At rest",
            .surfaces = {box},
            .without_webgl = "See the table."};
}

}  // namespace palpate
