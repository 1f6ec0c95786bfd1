// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/deformation.hpp"

#include <algorithm>

#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

/// Columns are the edges from the first corner.
Mat3 edges_of(const std::array<Vec3, 4>& corners) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = corners[k + 1] - corners[0];
    return edges;
}

struct TetDeformation {
    double volume_mm3 = 0;
    Mat3 gradient;  ///< of the displacement
};

TetDeformation deformation_of(const Mesh& mesh, const Tet& tet, const Eigen::VectorXd& u) {
    std::array<Vec3, 4> before, change;
    for (int k = 0; k < 4; ++k) {
        before[k] = mesh.nodes[tet[k]];
        change[k] = u.segment<3>(3 * tet[k]);
    }
    const Mat3 edges = edges_of(before);
    return {edges.determinant() / 6, edges_of(change) * edges.inverse()};
}

template <class Law>
double energy_density(const Law& law, const Mat3& gradient) {
    Tensor3<double> h;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) h.m[3 * i + j] = gradient(i, j);
    const auto state = law.state(h);
    return state.is_valid ? law.energy(state) : HUGE_VAL;
}

/// Of all elements of one region.
template <class Law>
RegionDeformation region_deformation(const Law& law, const Model& model, Index region,
                                     const Eigen::VectorXd& u) {
    RegionDeformation result{{HUGE_VAL, -HUGE_VAL}, 0};
    for (Index e = 0; e < model.mesh.num_tets(); ++e) {
        if (model.mesh.region[e] != region) continue;
        const TetDeformation tet = deformation_of(model.mesh, model.mesh.tets[e], u);
        const double jacobian = (Mat3::Identity() + tet.gradient).determinant();
        result.jacobian_range = {std::min(result.jacobian_range[0], jacobian),
                                 std::max(result.jacobian_range[1], jacobian)};
        result.strain_energy_mj += tet.volume_mm3 * energy_density(law, tet.gradient) / 1000;
    }
    if (result.jacobian_range[0] > result.jacobian_range[1]) result.jacobian_range = {1, 1};
    return result;
}

}  // namespace

std::vector<RegionDeformation> region_deformations(const Model& model, TissueLaw law,
                                                   const Eigen::VectorXd& displacement) {
    const std::vector<SolidMaterial> materials = solid_model_of(model, law).materials;
    std::vector<RegionDeformation> results(materials.size());
    for (std::size_t r = 0; r < results.size(); ++r) {
        if (!(model.materials[r].stiffness_kpa > 0)) continue;  // nothing of it is meshed
        with_material_law<double>(
            materials[r].law, materials[r].parameters, [&](const auto& known) {
                results[r] = region_deformation(known, model, static_cast<Index>(r), displacement);
            });
    }
    return results;
}

}  // namespace palpate
