// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// A surface made of the vertices of another: which of them, some more than once or never, and the
/// triangles between these.
struct DerivedShape {
    std::vector<Index> source;  ///< [vertices]
    std::vector<Triangle> triangles;

    template <class T>
    std::vector<T> of(const std::vector<T>& values) const {
        std::vector<T> out;
        out.reserve(source.size());
        for (const Index vertex : source) out.push_back(values[vertex]);
        return out;
    }
};

/// One vertex for each cube of this edge, the nearest to the mean of those in it, by vertex
/// clustering (Rossignac and Borrel, 1993); triangles that lose a side are gone. Small edges keep
/// all, but for vertices without a triangle.
DerivedShape thinned(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
                     double edge_mm);

/// The same with cubes just so large that there are at most so many triangles.
DerivedShape thinned_to(std::size_t most, const std::vector<Vec3>& vertices,
                        const std::vector<Triangle>& triangles);

/// Vertices on edges where the surface turns by more than 40 degrees or more than two triangles
/// meet stand once for each side, so that each side has normals of its own.
DerivedShape split_at_creases(const std::vector<Vec3>& vertices,
                              const std::vector<Triangle>& triangles);

}  // namespace palpate
