// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/nested_objective.hpp"

#include <algorithm>
#include <cmath>

#include "solver/adjoint/adjoint.hpp"
#include "solver/base/error.hpp"
#include "solver/linear/direct.hpp"
#include "solver/model/stiffness_matrix.hpp"
#include "solver/model/tet4_model.hpp"

namespace palpate {
namespace {

std::vector<Index> observed_unknown_regions(const RecoveryModel& recovery) {
    const SolidMesh& mesh = recovery.model.mesh;
    std::vector<char> is_observed(mesh.nodes.size(), 0);
    for (const Index node : recovery.observed) is_observed[node] = 1;
    std::vector<char> is_touched(recovery.model.materials.size(), 0);
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        for (const Index node : mesh.nodes_of(e)) is_touched[mesh.region[e]] |= is_observed[node];
    }
    std::vector<Index> regions;
    std::copy_if(recovery.unknown.begin(), recovery.unknown.end(), std::back_inserter(regions),
                 [&](Index region) { return is_touched[region] != 0; });
    return regions;
}

Model with_free_walls(const RecoveryModel& recovery) {
    Model model = tet4_model_of(recovery.model);
    for (const Index node : recovery.driven) {
        for (int c = 0; c < 3; ++c) model.prescribed[3 * node + c] = 0;
    }
    return model;
}

std::vector<double> moduli_of(const Model& model) {
    std::vector<double> stiffness;
    for (const auto& material : model.materials) stiffness.push_back(material.stiffness_kpa);
    return stiffness;
}

/// The components of `nodes` in a vector over all nodes of a mesh: [3 nodes.size()].
Eigen::VectorXd gathered(const Eigen::VectorXd& all, const std::vector<Index>& nodes) {
    Eigen::VectorXd part(3 * static_cast<Index>(nodes.size()));
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        part.segment<3>(3 * static_cast<Index>(k)) = all.segment<3>(3 * nodes[k]);
    }
    return part;
}

/// K u of the whole model, mN.
Eigen::VectorXd internal_force(const Model& model, const Eigen::VectorXd& displacement) {
    Eigen::VectorXd force(model.num_dofs());
    multiply_rows(assemble_stiffness(model), 0, model.mesh.num_nodes(), displacement.data(), 1, {},
                  force.data());
    return force;
}

}  // namespace

NestedObjective::NestedObjective(const RecoveryModel& recovery,
                                 const SurfaceObservations& observations,
                                 const std::string& direct_library)
    : recovery_(recovery),
      observations_(observations),
      free_(with_free_walls(recovery)),
      held_(tet4_model_of(recovery.model)),
      unknown_(observed_unknown_regions(recovery)) {
    if (recovery.fixed.empty()) {
        throw Error(ErrorCode::input_unusable,
                    "nested-lbfgs needs something that is fixed, or the free model would float; "
                    "give an organ the role 'fixed', set outer_boundary_fixed, or use the method "
                    "'map'");
    }
    solver_options_.direct_library = direct_library;
}

void NestedObjective::set_moduli(const Eigen::VectorXd& theta) {
    for (std::size_t k = 0; k < unknown_.size(); ++k) {
        // theta = ln E
        const double stiffness_kpa = std::exp(theta[static_cast<Index>(k)]);
        free_.materials[unknown_[k]].stiffness_kpa = stiffness_kpa;
        held_.materials[unknown_[k]].stiffness_kpa = stiffness_kpa;
    }
    if (!free_solver_) {
        free_solver_ = make_direct_solver(free_, solver_options_);
    } else {
        free_solver_->set_stiffness(moduli_of(free_));
    }
}

Eigen::VectorXd NestedObjective::starting_force() {
    if (!held_solver_) {
        held_solver_ = make_direct_solver(held_, solver_options_);
    } else {
        held_solver_->set_stiffness(moduli_of(held_));
    }
    const ObservedState seen = observe(Eigen::VectorXd::Zero(held_.num_dofs()));
    Eigen::VectorXd moved = Eigen::VectorXd::Zero(held_.num_dofs());
    const auto& rows = observations_.rows();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Index row = static_cast<Index>(k);
        if (!rows[k].on_driven) continue;
        // -r n at the walls' nodes brings each onto the target; f = K u of that is a start.
        moved.segment<3>(3 * rows[k].node) =
            -seen.residual_mm[row] * seen.normal.row(row).transpose();
    }
    return nodes_to_driven(internal_force(held_, solve(*held_solver_, moved)));
}

NestedState NestedObjective::evaluate(const Eigen::VectorXd& force) {
    NestedState state;
    state.displacement = solve(*free_solver_, driven_to_nodes(force));
    const ObservedState seen = observe(state.displacement);
    // Phi = 1/2 sum r_k(u)^2, K(E) u = f
    state.value_mm2 = 0.5 * seen.residual_mm.squaredNorm();
    state.gradient = Eigen::VectorXd::Zero(free_.num_dofs());
    const auto& rows = observations_.rows();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Index row = static_cast<Index>(k);
        // dPhi/du = sum r_k n_k
        state.gradient.segment<3>(3 * rows[k].node) +=
            seen.residual_mm[row] * seen.normal.row(row).transpose();
    }
    // dPhi/df = K^-1 dPhi/du, K symmetric: the adjoint solve, at driven nodes
    state.force_gradient = nodes_to_driven(solve(*free_solver_, state.gradient));
    return state;
}

Eigen::VectorXd NestedObjective::modulus_gradient(const NestedState& state) {
    const AdjointGradient gradient =
        adjoint_gradient(free_, *free_solver_, state.displacement, state.gradient);
    ++num_solves_;
    Eigen::VectorXd of_theta(static_cast<Index>(unknown_.size()));
    for (std::size_t k = 0; k < unknown_.size(); ++k) {
        of_theta[static_cast<Index>(k)] =
            // dPhi/d ln E = E dPhi/dE, dPhi/dE = -lambda . K_r u (method.md, 9.12)
            gradient.stiffness_kpa[unknown_[k]] * free_.materials[unknown_[k]].stiffness_kpa;
    }
    return of_theta;
}

double NestedObjective::curvature(const NestedState& state, const Eigen::VectorXd& direction) {
    const Eigen::VectorXd moved = solve(*free_solver_, driven_to_nodes(direction));
    const ObservedState seen = observe(state.displacement);
    double sum = 0;
    const auto& rows = observations_.rows();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double along =
            seen.normal.row(static_cast<Index>(k)).dot(moved.segment<3>(3 * rows[k].node));
        // d^T (d2Phi/df2) d = |G K^-1 d|^2, planes in place of surfaces (Gauss-Newton)
        sum += along * along;
    }
    return sum;
}

ObservedState NestedObjective::observe(const Eigen::VectorXd& displacement) const {
    ObservedState state = observations_.evaluate(gathered(displacement, recovery_.driven),
                                                 gathered(displacement, recovery_.observed));
    for (std::size_t k = 0; k < state.seen.size(); ++k) {
        if (!state.seen[k]) state.residual_mm[static_cast<Index>(k)] = 0;
    }
    return state;
}

Eigen::VectorXd NestedObjective::driven_to_nodes(const Eigen::VectorXd& driven) const {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(free_.num_dofs());
    for (std::size_t k = 0; k < recovery_.driven.size(); ++k) {
        all.segment<3>(3 * recovery_.driven[k]) = driven.segment<3>(3 * static_cast<Index>(k));
    }
    return all;
}

Eigen::VectorXd NestedObjective::nodes_to_driven(const Eigen::VectorXd& nodes) const {
    return gathered(nodes, recovery_.driven);
}

/// Right-hand sides are zero at fixed nodes, whose displacement is zero.
Eigen::VectorXd NestedObjective::solve(LinearSolver& solver, const Eigen::VectorXd& right) {
    Columns b = right;
    for (const Index node : recovery_.fixed) b.middleRows<3>(3 * node).setZero();
    Columns x;
    const LinearSolverSummary summary = solver.solve(b, x);
    ++num_solves_;
    if (!summary.converged) {
        throw Error(ErrorCode::solve_failed, "nested-lbfgs: " + summary.message);
    }
    return x.col(0);
}

}  // namespace palpate
