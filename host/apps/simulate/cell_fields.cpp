// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/cell_fields.hpp"

#include <Eigen/LU>
#include <cmath>
#include <optional>
#include <variant>

#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

Mat3 matrix_of(const Tensor3<double>& t) {
    Mat3 m;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m(i, j) = t.m[3 * i + j];
    return m;
}

double energy_density(const SolidMaterial& material, const Tensor3<double>& gradient) {
    double energy = 0;
    with_material_law<double>(material.law, material.parameters,
                              [&](const auto& law) { energy = law.energy(law.state(gradient)); });
    return energy;
}

/// sqrt(3/2 s:s) of the deviator s.
double von_mises(const std::array<double, 6>& t) {
    const double mean = (t[0] + t[1] + t[2]) / 3;
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += (t[k] - mean) * (t[k] - mean) + 2 * t[3 + k] * t[3 + k];
    return std::sqrt(1.5 * sum);
}

/// J and the Cauchy stress P F^T / J; small strains know no difference between stresses.
struct Spatial {
    double volume_ratio;
    Mat3 stress;
};
Spatial spatial_of(const PointState& point, bool is_small_strain) {
    const Mat3 h = matrix_of(point.gradient), p = matrix_of(point.stress);
    if (is_small_strain) return {1 + h.trace(), p};
    const Mat3 f = h + Mat3::Identity();
    const double j = f.determinant();
    return {j, p * f.transpose() / j};
}

}  // namespace

CellFields cell_fields(const SolidAssembly& solid, const Eigen::VectorXd& u) {
    const SolidModel& model = solid.model();
    const std::vector<PointState> states = solid.point_states(u);
    const auto per_element = static_cast<std::size_t>(model.mesh.table().num_points);
    CellFields fields;
    for (Index e = 0; e < model.mesh.num_elements(); ++e) {
        const SolidMaterial& material = model.materials[model.mesh.region[e]];
        const bool is_small_strain = material.law == LinearLaw<double>::description().name;
        double volume = 0, ratio = 0, energy = 0;
        Mat3 stress = Mat3::Zero();
        for (std::size_t q = 0; q < per_element; ++q) {
            const PointState& point = states[e * per_element + q];
            const Spatial spatial = spatial_of(point, is_small_strain);
            volume += point.volume;
            ratio += point.volume * spatial.volume_ratio;
            energy += point.volume * energy_density(material, point.gradient);
            stress += point.volume * spatial.stress;
        }
        stress /= volume;
        fields.stress_kpa.push_back(
            {stress(0, 0), stress(1, 1), stress(2, 2), stress(0, 1), stress(1, 2), stress(0, 2)});
        fields.von_mises_kpa.push_back(von_mises(fields.stress_kpa.back()));
        fields.volume_ratio.push_back(ratio / volume);
        fields.energy_density_kpa.push_back(energy / volume);
    }
    return fields;
}

}  // namespace palpate
