// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "solver/model/solid_mesh.hpp"

namespace palpate {

/// A place in an element: u = sum_a N_a u_a.
struct ProbedPlace {
    std::vector<Index> nodes;
    std::vector<double> weights;
    Vec3 displacement(const Eigen::VectorXd& u) const;  ///< of u [3 num_nodes]
};

/// Finds places in the undeformed mesh, of any element.
class MeshProbe {
public:
    /// `mesh` must outlive the probe.
    explicit MeshProbe(const SolidMesh& mesh) : mesh_(mesh) {}
    /// Empty if the place (mm) is outside the body by more than 1e-6 of an element's size.
    std::optional<ProbedPlace> find(const Vec3& place) const;

private:
    std::optional<std::array<double, 3>> inside(Index element, const Vec3& place) const;
    const SolidMesh& mesh_;
};

}  // namespace palpate
