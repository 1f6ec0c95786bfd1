// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/adjoint.hpp"

#include <string>

#include "solver/base/error.hpp"
#include "solver/elements/tet4.hpp"

namespace palpate {
namespace {

using Corners = Eigen::Matrix<double, 12, Eigen::Dynamic>;

Corners at_corners(const Columns& x, const Tet& tet) {
    Corners corners(12, x.cols());
    for (int a = 0; a < 4; ++a) corners.middleRows<3>(3 * a) = x.middleRows<3>(3 * tet[a]);
    return corners;
}

/// K_ff^-1 (dJ/du)_f, zero on prescribed dofs.
Columns solve_adjoint(const Model& model, LinearSolver& solver, const Columns& dj_du,
                      const ProgressSink& progress) {
    Columns b = dj_du;
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) b.row(d).setZero();
    Columns lambda;
    const LinearSolverSummary summary = solver.solve(b, lambda, progress);
    if (!summary.converged)
        throw Error(ErrorCode::solve_failed,
                    "The adjoint solve stopped at a relative residual of " +
                        std::to_string(summary.relative_residual) + ": " + summary.message + ".");
    return lambda;
}

}  // namespace

LoadGradient load_gradient(const Model& model, LinearSolver& solver, const Columns& u,
                           const Columns& dj_du, const ProgressSink& progress) {
    if (u.rows() != model.num_dofs() || dj_du.rows() != u.rows() || dj_du.cols() != u.cols())
        throw Error(ErrorCode::invalid_argument,
                    "The adjoint gradient got " + std::to_string(u.rows()) + " displacements and " +
                        std::to_string(dj_du.rows()) + " derivatives for " +
                        std::to_string(model.num_dofs()) + " degrees of freedom.");
    LoadGradient gradient;
    gradient.load = solve_adjoint(model, solver, dj_du, progress);
    gradient.stiffness_kpa = Eigen::VectorXd::Zero(model.materials.size());
    Columns reaction = Columns::Zero(u.rows(), u.cols());  // K lambda
    for (Index t = 0; t < model.mesh.num_tets(); ++t) {
        const Tet& tet = model.mesh.tets[t];
        const Index region = model.mesh.region[t];
        const LinearElastic& material = model.materials[region];
        const Tet4 geometry = tet4_geometry(model.mesh.nodes[tet[0]], model.mesh.nodes[tet[1]],
                                            model.mesh.nodes[tet[2]], model.mesh.nodes[tet[3]]);
        const Corners force = tet4_stiffness(geometry, material.unit_lambda(), material.unit_mu()) *
                              at_corners(gradient.load, tet);
        gradient.stiffness_kpa[region] -= force.cwiseProduct(at_corners(u, tet)).sum();
        for (int a = 0; a < 4; ++a)
            reaction.middleRows<3>(3 * tet[a]) +=
                material.stiffness_kpa * force.middleRows<3>(3 * a);
    }
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) gradient.load.row(d) = dj_du.row(d) - reaction.row(d);
    return gradient;
}

AdjointGradient adjoint_gradient(const Model& model, LinearSolver& solver, const Eigen::VectorXd& u,
                                 const Eigen::VectorXd& dj_du) {
    const LoadGradient all = load_gradient(model, solver, u, dj_du);
    AdjointGradient gradient{all.load.col(0), all.stiffness_kpa};
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (!model.prescribed[d]) gradient.displacement[d] = 0;
    return gradient;
}

}  // namespace palpate
