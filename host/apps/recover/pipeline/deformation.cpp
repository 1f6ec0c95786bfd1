// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/deformation.hpp"

#include <algorithm>

#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

/// What the points of a mesh are made of.
struct Points {
    const SolidMesh& mesh;
    std::vector<PointGeometry> geometry = point_geometry(mesh);

    /// H = sum_a u_a (outer) dN_a/dX at point q of an element.
    Mat3 displacement_gradient(Index element, int q, const Eigen::VectorXd& u) const {
        const auto nodes = mesh.nodes_of(element);
        Mat3 h = Mat3::Zero();
        for (std::size_t a = 0; a < nodes.size(); ++a)
            h += u.segment<3>(3 * nodes[a]) *
                 Eigen::Map<const Eigen::RowVector3d>(at(element, q).gradient[a].data());
        return h;
    }
    const PointGeometry& at(Index element, int q) const {
        return geometry[static_cast<std::size_t>(element) * mesh.table().num_points + q];
    }
};

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
RegionDeformation region_deformation(const Law& law, const Points& points, Index region,
                                     const Eigen::VectorXd& u) {
    RegionDeformation result{{HUGE_VAL, -HUGE_VAL}, 0};
    for (Index e = 0; e < points.mesh.num_elements(); ++e) {
        if (points.mesh.region[e] != region) continue;
        for (int q = 0; q < points.mesh.table().num_points; ++q) {
            const Mat3 gradient = points.displacement_gradient(e, q, u);
            const double jacobian = (Mat3::Identity() + gradient).determinant();
            result.jacobian_range = {std::min(result.jacobian_range[0], jacobian),
                                     std::max(result.jacobian_range[1], jacobian)};
            result.strain_energy_mj +=
                points.at(e, q).volume * energy_density(law, gradient) / 1000;
        }
    }
    if (result.jacobian_range[0] > result.jacobian_range[1]) result.jacobian_range = {1, 1};
    return result;
}

}  // namespace

std::vector<RegionDeformation> region_deformations(const SolidModel& model, const TissueLaw& law,
                                                   const Eigen::VectorXd& displacement) {
    const Points points{model.mesh};
    std::vector<RegionDeformation> results(model.materials.size());
    for (std::size_t r = 0; r < results.size(); ++r) {
        const SolidMaterial material = with_law(model.materials[r], law);
        with_material_law<double>(material.law, material.parameters, [&](const auto& known) {
            results[r] = region_deformation(known, points, static_cast<Index>(r), displacement);
        });
    }
    return results;
}

}  // namespace palpate
