// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/apps/simulate/picture_frame.hpp"

namespace palpate {

/// A point of an edge: that part of the way from node a to node b.
struct PicturePoint {
    Index a = 0, b = 0;
    double part = 0;

    template <class T>
    T of(const std::vector<T>& nodal) const {
        return T(nodal[a] + part * (nodal[b] - nodal[a]));
    }
};

/// What a picture draws of a mesh: polygons between points that nodes carry along.
struct PictureShape {
    PictureView view;
    bool is_closed = false;    ///< a surface whose far side is hidden
    bool is_mirrored = false;  ///< half of a section through an axis
    std::vector<PicturePoint> points;
    std::vector<std::vector<Index>> patches;  ///< points round the rim of each
};

/// A solid's surface seen obliquely, or a plane mesh itself.
PictureShape body_shape(const SolidMesh& mesh);

/// A solid's section across y at this place (mm), seen from the front; middles of edges count as on
/// the straight edge.
PictureShape section_shape(const SolidMesh& mesh, double y_mm);

}  // namespace palpate
