// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/full_model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/apps/recover/pipeline/mechanics.hpp"
#include "solver/base/error.hpp"
#include "solver/equilibrium/rest_solver.hpp"

namespace palpate {
namespace {

/// Largest difference allowed between the response model and the full one at an observed node, mm:
/// a few times what the response model leaves out on average, far below the noise of a voxel.
constexpr double response_tolerance_mm = 0.5;

void set_moduli(Recovered& found) {
    for (std::size_t k = 0; k < found.estimate.unknown.size(); ++k) {
        set_stiffness(found.recovery.model, found.estimate.unknown[k].object,
                      std::exp(found.estimate.theta[static_cast<Index>(k)]));
    }
}

/// f = K u on the host in fp64, kept at prescribed nodes; [num_dofs, columns].
Columns reactions(const SolidModel& model, const Columns& displacement) {
    const StiffnessMatrix stiffness = stiffness_at_rest(model);
    Columns force(displacement.rows(), displacement.cols());
    multiply_rows(stiffness, 0, model.mesh.num_nodes(), displacement.data(),
                  static_cast<Index>(displacement.cols()), {}, force.data());
    for (Index dof = 0; dof < model.num_dofs(); ++dof) {
        if (!model.prescribed[dof]) force.row(dof).setZero();
    }
    return force;
}

/// Surfaces of driven organs, by their places in `recovery.surfaces`.
std::vector<std::size_t> driven_surfaces(const RecoveryModel& recovery) {
    std::vector<std::size_t> driven;
    for (std::size_t s = 0; s < recovery.surfaces.size(); ++s) {
        if (recovery.surfaces[s].driven) driven.push_back(s);
    }
    return driven;
}

/// The estimated motion of the walls, then the rigid translations along the axes of each driven
/// organ; [num_dofs, 1 + 3 driven].
Columns wall_motions(const Recovered& found, const std::vector<std::size_t>& driven) {
    const RecoveryModel& recovery = found.recovery;
    Columns moved = Columns::Zero(recovery.model.num_dofs(), 1 + 3 * driven.size());
    for (std::size_t k = 0; k < recovery.driven.size(); ++k) {
        moved.block<3, 1>(3 * recovery.driven[k], 0) =
            found.estimate.driven.segment<3>(3 * static_cast<Index>(k));
    }
    for (std::size_t d = 0; d < driven.size(); ++d) {
        for (const Index node : recovery.surfaces[driven[d]].node_of) {
            if (!std::binary_search(recovery.driven.begin(), recovery.driven.end(), node)) continue;
            moved.block<3, 3>(3 * node, 1 + 3 * d).setIdentity();
        }
    }
    return moved;
}

void check_against_response(const Recovered& found) {
    double difference = 0;
    for (std::size_t k = 0; k < found.recovery.observed.size(); ++k) {
        const Vec3 full = found.displacement.segment<3>(3 * found.recovery.observed[k]);
        Vec3 response = found.estimate.observed.segment<3>(3 * static_cast<Index>(k));
        if (found.mesh_change.size() > 0)
            response -= found.mesh_change.segment<3>(3 * static_cast<Index>(k));
        difference = std::max(difference, (full - response).norm());
    }
    if (difference > response_tolerance_mm) {
        throw Error(ErrorCode::solve_failed,
                    fmt::format("the full model differs from the one used by the search by {:.2g} "
                                "mm; try --precision double or --linear-solver direct",
                                difference));
    }
}

/// The resultant force on a driven organ is linear in the wall motion, e^T K u(u_d) = (S_dd e)^T
/// u_d for rigid translations e of that organ: the reactions to them are its gradient. Standard
/// deviation at the estimated moduli, from what the data leave open of the motion.
///   force  reactions to `wall_motions`
std::vector<Vec3> resultant_deviations(const Recovered& found,
                                       const std::vector<std::size_t>& driven,
                                       const Columns& force) {
    const RecoveryModel& recovery = found.recovery;
    std::vector<Vec3> deviations(recovery.surfaces.size(), Vec3::Zero());
    if (!found.estimate.posterior || driven.empty()) return deviations;
    Eigen::MatrixXd gradients(3 * recovery.driven.size(), force.cols() - 1);
    for (std::size_t k = 0; k < recovery.driven.size(); ++k) {
        gradients.middleRows<3>(3 * k) =
            force.middleRows<3>(3 * recovery.driven[k]).rightCols(gradients.cols());
    }
    const Eigen::VectorXd variance =
        found.estimate.posterior->motion_covariance(found.estimate.theta, gradients)
            .diagonal()
            .cwiseMax(0.0);
    for (std::size_t d = 0; d < driven.size(); ++d) {
        deviations[driven[d]] = variance.segment<3>(3 * d).cwiseSqrt();
    }
    return deviations;
}

}  // namespace

void solve_full_model(Recovered& found, FullSolver& full_solver, const ProgressSink& progress) {
    set_moduli(found);
    const SolidModel& model = found.recovery.model;
    LinearSolver& solver = full_solver.at(moduli_of(model));
    const auto driven = driven_surfaces(found.recovery);
    Columns solution;
    const LinearSolverSummary summary =
        solver.solve(wall_motions(found, driven), solution, progress);
    if (!summary.converged) {
        throw Error(
            ErrorCode::solve_failed,
            fmt::format("the final solve stopped at a relative residual of {:.1e} ({}); try "
                        "--precision double or --linear-solver direct",
                        summary.relative_residual, summary.message));
    }
    found.displacement = solution.col(0);
    found.relative_residual = summary.relative_residual;
    found.solver = solver.describe();
    const Columns force = reactions(model, solution);
    found.force = force.col(0);
    found.resultant_sd = resultant_deviations(found, driven, force);
    check_against_response(found);
}

void take_equilibrium(Recovered& found) {
    set_moduli(found);
    const Equilibrium& state = found.finite->state;
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(state.displacement.size());
    const auto driven = driven_surfaces(found.recovery);
    const Columns moved = wall_motions(found, driven);
    Columns force(moved.rows(), moved.cols());
    force.col(0) = state.reaction;
    TangentSolve& tangent = *state.tangent;
    tangent.factorise(state.displacement);
    for (Index c = 1; c < moved.cols(); ++c) {
        Eigen::VectorXd answer = moved.col(c);
        tangent.solve(nothing, answer);
        force.col(c) = tangent.times(answer);
    }
    found.displacement = state.displacement;
    found.relative_residual = state.relative_residual;
    found.solver = found.finite->solver;
    found.force = force.col(0);
    found.resultant_sd = resultant_deviations(found, driven, force);
}

}  // namespace palpate
