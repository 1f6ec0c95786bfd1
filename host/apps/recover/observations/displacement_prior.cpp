// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/observations/displacement_prior.hpp"

#include <cmath>
#include <numbers>

namespace palpate {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Lumped mass (mm^2) and cotangent stiffness of one wall, scattered to driven positions.
void add_wall(const Surface& surface, const std::vector<Index>& position, Eigen::VectorXd& mass,
              Triplets& stiffness) {
    for (const auto& t : surface.triangles) {
        std::array<Vec3, 3> edge;  // opposite corner c
        for (int c = 0; c < 3; ++c) {
            edge[c] = surface.vertices[t[(c + 2) % 3]] - surface.vertices[t[(c + 1) % 3]];
        }
        const double area = 0.5 * edge[0].cross(edge[1]).norm();
        if (area <= 0) continue;
        for (int a = 0; a < 3; ++a) {
            if (position[t[a]] < 0) continue;
            mass[position[t[a]]] += area / 3.0;
            for (int b = 0; b < 3; ++b) {
                if (position[t[b]] < 0) continue;
                stiffness.emplace_back(position[t[a]], position[t[b]],
                                       edge[a].dot(edge[b]) / (4.0 * area));
            }
        }
    }
}

}  // namespace

Sparse displacement_precision(const RecoveryModel& recovery, double sd_mm, double range_mm) {
    const Index n = static_cast<Index>(recovery.driven.size());
    std::vector<Index> driven_position(recovery.model.mesh.nodes.size(), -1);
    for (Index k = 0; k < n; ++k) driven_position[recovery.driven[k]] = k;

    Eigen::VectorXd mass = Eigen::VectorXd::Zero(n);
    Triplets entries;
    for (const auto& surface : recovery.surfaces) {
        if (!surface.driven) continue;
        std::vector<Index> position(surface.node_of.size());
        for (std::size_t v = 0; v < position.size(); ++v) {
            position[v] = driven_position[surface.node_of[v]];
        }
        add_wall(surface.surface, position, mass, entries);
    }
    Sparse laplacian(n, n);
    laplacian.setFromTriplets(entries.begin(), entries.end());

    const double kappa_squared = 8.0 / (range_mm * range_mm);
    const double tau_squared = 1.0 / (4.0 * std::numbers::pi * kappa_squared * sd_mm * sd_mm);
    Sparse operator_matrix = laplacian;
    for (Index k = 0; k < n; ++k) operator_matrix.coeffRef(k, k) += kappa_squared * mass[k];
    const Sparse weighted = mass.cwiseInverse().asDiagonal() * operator_matrix;
    return tau_squared * (operator_matrix.transpose() * weighted);
}

}  // namespace palpate
