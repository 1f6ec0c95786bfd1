// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/solid_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/equilibrium/element_response.hpp"
#include "solver/equilibrium/element_slopes.hpp"
#include "solver/equilibrium/solid_tables.hpp"

namespace palpate {

SolidAssembly::SolidAssembly(const SolidModel& model, const ElementLoopOptions& loops)
    : tables_(std::make_unique<AssemblyTables>(model, loops)) {}

SolidAssembly::~SolidAssembly() = default;

const SolidModel& SolidAssembly::model() const { return tables_->model; }

const ElementLoopInfo& SolidAssembly::loops() const { return tables_->loops.describe(); }

InternalForce SolidAssembly::internal_force(const Eigen::VectorXd& u) const {
    const AssemblyTables& tables = *tables_;
    InternalForce result;
    if (tables.are_on_device()) {
        const SolidForce found = tables.loops.internal_force(u);
        result.energy = found.energy;
        result.force = Eigen::Map<const Eigen::VectorXd>(found.force.data(), u.size());
        result.is_valid = found.is_valid;
        return result;
    }
    result.force.setZero(tables.model.num_dofs());
    std::vector<double> energy(tables.model.mesh.region.size());
    // f_a += sum over points V P g_a (method.md, 9.2)
    const auto of_group = [&](Index g) {
        Pack stored, force[3 * most_element_nodes];
        if (!tables.groups.force(g, tables.step(), u.data(), stored, force)) return false;
        return tables.for_each_lane(g, [&](Index e, int lane) {
            energy[e] = stored[lane];
            const Pack* part = force;
            for (const Index node : tables.model.mesh.nodes_of(e))
                for (int i = 0; i < 3; ++i) result.force[3 * node + i] += (*part++)[lane];
        });
    };
    tables.for_each_group(of_group, [&](Index e) {
        const ElementPoints points = tables.points_of(e);
        tables.with_laws(e, [&](const auto& law_at) {
            const ElementForce found = element_force(tables.model, law_at, points, u);
            energy[e] = found.energy;
            for (std::size_t a = 0; a < points.nodes.size(); ++a)
                result.force.segment<3>(3 * points.nodes[a]) += found.force[a];
        });
    });
    // W = sum of the elements' in their order: the same bits with any number of threads
    for (const double part : energy) result.energy += part;
    result.is_valid = std::isfinite(result.energy) && result.force.allFinite();
    if (!result.is_valid) result.energy = std::numeric_limits<double>::infinity();
    return result;
}

BlockMatrix SolidAssembly::make_matrix() const {
    BlockMatrix matrix;
    matrix.graph = tables_->graph;
    matrix.num_columns = tables_->model.mesh.num_nodes();
    matrix.blocks.assign(9 * matrix.graph.items.size(), 0.0);
    return matrix;
}

void SolidAssembly::tangent(const Eigen::VectorXd& u, BlockMatrix& matrix) const {
    const AssemblyTables& tables = *tables_;
    if (tables.are_on_device()) return tables.loops.tangent(u, matrix);
    std::fill(matrix.blocks.begin(), matrix.blocks.end(), 0.0);
    const auto pairs = static_cast<std::size_t>(tables.model.mesh.table().num_nodes *
                                                tables.model.mesh.table().num_nodes);
    // (K_ab)_ij += sum V g_a,k dP_ik/dH_jl g_b,l (method.md, 9.2), all pairs (a, b) of nodes
    const auto of_group = [&](Index g) {
        Pack stiffness[9 * most_element_nodes * most_element_nodes];
        if (!tables.groups.tangent(g, tables.step(), u.data(), stiffness)) return false;
        return tables.for_each_lane(g, [&](Index e, int lane) {
            for (std::size_t pair = 0; pair < pairs; ++pair) {
                double* block = matrix.block(tables.blocks[e * pairs + pair]);
                for (int k = 0; k < 9; ++k) block[k] += stiffness[9 * pair + k][lane];
            }
        });
    };
    tables.for_each_group(of_group, [&](Index e) {
        ElementStiffness stiffness;
        tables.with_laws(e, [&](const auto& law_at) {
            element_tangent(tables.model, law_at, tables.points_of(e), u, stiffness);
        });
        for (std::size_t pair = 0; pair < pairs; ++pair) {
            double* block = matrix.block(tables.blocks[e * pairs + pair]);
            for (int k = 0; k < 9; ++k) block[k] += stiffness[9 * pair + k];
        }
    });
}

std::vector<std::vector<double>> SolidAssembly::parameter_products(
    const Eigen::VectorXd& u, const Eigen::VectorXd& lambda) const {
    const AssemblyTables& tables = *tables_;
    if (tables.are_on_device()) return tables.loops.parameter_products(u, lambda);
    ElementSlopes slopes(tables.model);
    tables.for_each_element([&](Index e) {
        tables.with_laws(e, [&](const auto& law_at) {
            // lambda . df/dp = sum V dP/dp : (sum_a lambda_a g_a^T), with (method.md, 9.12)
            add_parameter_products(tables.model, law_at, tables.points_of(e), u, lambda,
                                   slopes.parameters_of(e));
        });
    });
    return slopes.parameters();
}

std::vector<Eigen::MatrixXd> SolidAssembly::parameter_forces(const Eigen::VectorXd& u) const {
    const AssemblyTables& tables = *tables_;
    std::vector<Eigen::MatrixXd> forces;
    for (const SolidMaterial& material : tables.model.materials)
        forces.emplace_back(
            Eigen::MatrixXd::Zero(u.size(), static_cast<Eigen::Index>(material.parameters.size())));
    tables.for_each_element([&](Index e) {
        const ElementPoints points = tables.points_of(e);
        Eigen::MatrixXd& sum = forces[tables.model.mesh.region[e]];
        tables.with_laws(e, [&](const auto& law_at) {
            for (Eigen::Index k = 0; k < sum.cols(); ++k) {
                std::array<Vec3, most_element_nodes> force;
                force.fill(Vec3::Zero());
                // df_a/dp_k = sum V dP/dp_k g_a
                parameter_force(tables.model, law_at, points, u, static_cast<int>(k), force);
                for (std::size_t a = 0; a < points.nodes.size(); ++a)
                    sum.col(k).segment<3>(3 * points.nodes[a]) += force[a];
            }
        });
    });
    return forces;
}

std::vector<PointState> SolidAssembly::point_states(const Eigen::VectorXd& u) const {
    const AssemblyTables& tables = *tables_;
    const auto points = static_cast<std::size_t>(tables.model.mesh.table().num_points);
    std::vector<PointState> states(tables.geometry.size());
    tables.for_each_element([&](Index e) {
        const ElementPoints element = tables.points_of(e);
        tables.with_laws(e, [&](const auto& law_at) {
            with_response(tables.model, law_at, element, u, [&](const auto& response) {
                PointTensors stress{};
                // H, P and V at each point; P = 0 where matter is inverted
                if (response.is_valid()) response.stress(stress);
                for (std::size_t q = 0; q < points; ++q)
                    states[e * points + q] = {response.gradient(q), stress[q],
                                              element.geometry[q].volume};
            });
        });
    });
    return states;
}

}  // namespace palpate
