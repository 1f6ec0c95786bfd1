// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "solver/base/tensor3.hpp"
#include "solver/model/solid_geometry.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// What the loops need of one element.
struct ElementPoints {
    std::span<const Index> nodes;
    std::span<const PointGeometry> geometry;  ///< [num_points]

    // The interface of `SolidElement`:
    int num_points() const { return static_cast<int>(geometry.size()); }
    SolidPoint<double> point(int q) const {
        const PointGeometry& at = geometry[q];
        return {static_cast<int>(nodes.size()), at.gradient[0].data(), at.hoop.data(), at.volume};
    }
    Tensor3<double> displacement_gradient_at(int q, const double* u) const {
        return displacement_gradient(point(q), nodes.data(), u);
    }
};

using PointTensors = TensorsAtPoints<double>;

inline SolidPoint<double> point_of(const ElementPoints& element, const PointGeometry& at) {
    return {static_cast<int>(element.nodes.size()), at.gradient[0].data(), at.hoop.data(),
            at.volume};
}

/// H at one point of the displacement u [3 num_nodes].
inline Tensor3<double> displacement_gradient(const ElementPoints& element, const PointGeometry& at,
                                             const Eigen::VectorXd& u) {
    return displacement_gradient(point_of(element, at), element.nodes.data(), u.data());
}

/// dH by component j of node b.
inline Tensor3<double> unit_gradient(const PointGeometry& at, std::size_t b, int j) {
    Tensor3<double> h{};
    for (int k = 0; k < 3; ++k) h.m[3 * j + k] = at.gradient[b][k];
    if (j == 0) h.m[8] += at.hoop[b];
    return h;
}

/// P : dH/du_a, the force of the stress P on node a, without the volume.
inline Vec3 force_on(const Tensor3<double>& stress, const PointGeometry& at, std::size_t a) {
    Vec3 force;
    for (int i = 0; i < 3; ++i)
        force[i] = stress.m[3 * i] * at.gradient[a][0] + stress.m[3 * i + 1] * at.gradient[a][1] +
                   stress.m[3 * i + 2] * at.gradient[a][2];
    force[0] += stress.m[8] * at.hoop[a];
    return force;
}

}  // namespace palpate
