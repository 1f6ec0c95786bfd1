// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/lumped_mass.hpp"

#include <array>

namespace palpate {

Eigen::VectorXd lumped_mass(const SolidMesh& mesh, double density_kg_per_m3) {
    constexpr double m3_per_mm3 = 1e-9;
    const ElementTable& table = mesh.table();
    const std::vector<PointGeometry> geometry = point_geometry(mesh);
    Eigen::VectorXd mass = Eigen::VectorXd::Zero(mesh.num_nodes());
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        double volume = 0, sum = 0;
        std::array<double, most_element_nodes> share{};
        for (int q = 0; q < table.num_points; ++q) {
            const double part = geometry[static_cast<std::size_t>(e) * table.num_points + q].volume;
            volume += part;
            for (int a = 0; a < table.num_nodes; ++a) {
                const double value = table.value[q * table.num_nodes + a];
                share[a] += part * value * value;
                sum += part * value * value;
            }
        }
        for (int a = 0; a < table.num_nodes; ++a)
            mass[mesh.nodes_of(e)[a]] += density_kg_per_m3 * m3_per_mm3 * volume * share[a] / sum;
    }
    return mass;
}

}  // namespace palpate
