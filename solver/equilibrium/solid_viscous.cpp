// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// What a viscous step, and the sensitivities through a load history, ask of a SolidAssembly.
#include <array>
#include <type_traits>

#include "solver/base/error.hpp"
#include "solver/equilibrium/element_slopes.hpp"
#include "solver/equilibrium/solid_assembly.hpp"
#include "solver/equilibrium/solid_tables.hpp"

namespace palpate {

void SolidAssembly::set_viscous_step(std::vector<double> factor,
                                     std::vector<Tensor3<double>> prestress) {
    if (factor.size() != tables_->model.materials.size() ||
        prestress.size() != tables_->geometry.size())
        throw Error(ErrorCode::invalid_argument,
                    "a viscous step needs a factor per material and a stress per point");
    tables_->factor = std::move(factor);
    tables_->prestress = std::move(prestress);
}

std::vector<Tensor3<double>> SolidAssembly::relaxing_stress(const Eigen::VectorXd& u) const {
    const AssemblyTables& tables = *tables_;
    const auto points = static_cast<std::size_t>(tables.model.mesh.table().num_points);
    std::vector<Tensor3<double>> stress(tables.geometry.size(), Tensor3<double>{});
    const auto of_group = [&](Index g) {
        Tensor3<Pack> found[most_element_points];
        if (!tables.groups.relaxing_stress(g, tables.step(), u.data(), found)) return false;
        return tables.for_each_lane(g, [&](Index e, int lane) {
            for (std::size_t q = 0; q < points; ++q)
                for (int i = 0; i < 9; ++i) stress[e * points + q].m[i] = found[q].m[i][lane];
        });
    };
    tables.for_each_group(of_group, [&](Index e) {
        const Index region = tables.model.mesh.region[e];
        if (tables.model.materials[region].relaxation.empty()) return;
        const ElementPoints element = tables.points_of(e);
        PointTensors h;
        tables.with_laws(
            e, [&](const auto& law_at) { law_gradients(tables.model, law_at, element, u, h); });
        const bool is_total = tables.model.materials[region].relaxation_of == RelaxationOf::total;
        std::visit(
            [&](const auto& law) {
                for (std::size_t q = 0; q < points; ++q)
                    // S = F^-1 P of the law, or of its isochoric part, without its history
                    stress[e * points + q] = is_total ? second_piola(law, h[q])
                                                      : second_piola(isochoric_part(law), h[q]);
            },
            tables.laws[region]);
    });
    return stress;
}

Eigen::VectorXd SolidAssembly::relaxing_stress_gradient(
    const Eigen::VectorXd& u, const std::vector<Tensor3<double>>& slope) const {
    const AssemblyTables& tables = *tables_;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(u.size());
    tables.for_each_element([&](Index e) {
        const ElementPoints points = tables.points_of(e);
        tables.with_laws(e, [&](const auto& law_at) {
            if constexpr (gives_viscous_step<decltype(law_at)>) {
                // dJ/du_a += sum (dJ/dS : dS/dH) g_a
                const auto found = element_stress_gradient(tables.model, law_at, points, u,
                                                           tables.of_element(slope, e));
                for (std::size_t a = 0; a < points.nodes.size(); ++a)
                    gradient.segment<3>(3 * points.nodes[a]) += found[a];
            }
        });
    });
    return gradient;
}

ViscousSlopes SolidAssembly::viscous_slopes(const Eigen::VectorXd& u, const Eigen::VectorXd& lambda,
                                            const std::vector<Tensor3<double>>& slope) const {
    const AssemblyTables& tables = *tables_;
    // dJ = -lambda . df (method.md, 9.14), df by Q, by 1 + sum c_k and by the law's parameters
    const Eigen::VectorXd direction = -lambda;
    ElementSlopes slopes(tables.model);
    ViscousSlopes result;
    result.prestress.assign(slope.size(), Tensor3<double>{});
    tables.for_each_element([&](Index e) {
        const ElementPoints points = tables.points_of(e);
        tables.with_laws(e, [&](const auto& law_at) {
            if constexpr (gives_viscous_step<decltype(law_at)>) {
                add_viscous_slopes(tables.model, law_at, points, u, direction,
                                   tables.of_element(slope, e),
                                   {tables.of_element(result.prestress, e), slopes.factor_of(e),
                                    slopes.parameters_of(e)});
            } else {
                add_parameter_products(tables.model, law_at, points, u, direction,
                                       slopes.parameters_of(e));
            }
        });
    });
    result.factor = slopes.factor();
    result.parameters = slopes.parameters();
    return result;
}

Eigen::MatrixXd SolidAssembly::force_changes(const Eigen::VectorXd& u,
                                             const std::vector<SolidChange>& changes) const {
    const AssemblyTables& tables = *tables_;
    Eigen::MatrixXd sum =
        Eigen::MatrixXd::Zero(u.size(), static_cast<Eigen::Index>(changes.size()));
    // df_a += sum V dP g_a, u held (method.md, 9.15)
    const auto of_group = [&](Index g) {
        std::vector<Pack> found;
        if (!tables.groups.force_changes(g, tables.step(), u.data(), changes, found)) return false;
        return tables.for_each_lane(g, [&](Index e, int lane) {
            const Pack* part = found.data();
            for (Eigen::Index c = 0; c < sum.cols(); ++c)
                for (const Index node : tables.model.mesh.nodes_of(e))
                    for (int i = 0; i < 3; ++i) sum(3 * node + i, c) += (*part++)[lane];
        });
    };
    tables.for_each_group(of_group, [&](Index e) {
        const ElementPoints points = tables.points_of(e);
        std::array<Vec3, most_element_nodes> none;
        none.fill(Vec3::Zero());
        std::vector<std::array<Vec3, most_element_nodes>> forces(changes.size(), none);
        tables.with_laws(e, [&](const auto& law_at) {
            add_force_changes(tables.model, law_at, points, u, tables.changes_of(e, changes),
                              forces);
        });
        for (std::size_t c = 0; c < forces.size(); ++c)
            for (std::size_t a = 0; a < points.nodes.size(); ++a)
                sum.col(static_cast<Eigen::Index>(c)).segment<3>(3 * points.nodes[a]) +=
                    forces[c][a];
    });
    return sum;
}

std::vector<std::vector<Tensor3<double>>> SolidAssembly::relaxing_stress_changes(
    const Eigen::VectorXd& u, const Eigen::MatrixXd& du,
    const std::vector<SolidChange>& changes) const {
    const AssemblyTables& tables = *tables_;
    const auto points = static_cast<std::size_t>(tables.model.mesh.table().num_points);
    std::vector<std::vector<Tensor3<double>>> stress(
        changes.size(), std::vector<Tensor3<double>>(tables.geometry.size(), Tensor3<double>{}));
    const auto of_group = [&](Index g) {
        std::vector<Tensor3<Pack>> found;
        if (!tables.groups.relaxing_stress_changes(g, tables.step(), u.data(), du, changes, found))
            return false;
        return tables.for_each_lane(g, [&](Index e, int lane) {
            const Tensor3<Pack>* part = found.data();
            for (std::vector<Tensor3<double>>& of_change : stress)
                for (std::size_t q = 0; q < points; ++q, ++part)
                    for (int i = 0; i < 9; ++i) of_change[e * points + q].m[i] = part->m[i][lane];
        });
    };
    tables.for_each_group(of_group, [&](Index e) {
        tables.with_laws(e, [&](const auto& law_at) {
            if constexpr (gives_viscous_step<decltype(law_at)>)
                palpate::relaxing_stress_changes(
                    tables.model, law_at, tables.points_of(e), u, du, tables.changes_of(e, changes),
                    [&](std::size_t c, std::size_t q, const Tensor3<double>& change) {
                        stress[c][e * points + q] = change;
                    });
        });
    });
    return stress;
}

}  // namespace palpate
