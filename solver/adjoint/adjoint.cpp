// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/adjoint.hpp"

#include "solver/base/error.hpp"
#include "solver/elements/tet4.hpp"

namespace palpate {
namespace {

using Corners = Eigen::Matrix<double, 12, 1>;

Corners at_corners(const Eigen::VectorXd& x, const Tet& tet) {
    Corners corners;
    for (int a = 0; a < 4; ++a) corners.segment<3>(3 * a) = x.segment<3>(3 * tet[a]);
    return corners;
}

Eigen::VectorXd solve_adjoint(const Model& model, LinearSolver& solver,
                              const Eigen::VectorXd& dj_du) {
    Columns b = -dj_du;
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) b(d, 0) = 0;
    Columns lambda;
    const LinearSolverSummary summary = solver.solve(b, lambda);
    if (!summary.converged)
        throw Error(ErrorCode::solve_failed,
                    "The adjoint solve stopped at a relative residual of " +
                        std::to_string(summary.relative_residual) + ": " + summary.message + ".");
    return lambda.col(0);
}

}  // namespace

AdjointGradient adjoint_gradient(const Model& model, LinearSolver& solver, const Eigen::VectorXd& u,
                                 const Eigen::VectorXd& dj_du) {
    if (u.size() != model.num_dofs() || dj_du.size() != model.num_dofs())
        throw Error(ErrorCode::invalid_argument,
                    "The adjoint gradient got " + std::to_string(u.size()) + " displacements and " +
                        std::to_string(dj_du.size()) + " derivatives for " +
                        std::to_string(model.num_dofs()) + " degrees of freedom.");
    const Eigen::VectorXd lambda = solve_adjoint(model, solver, dj_du);

    AdjointGradient gradient;
    gradient.displacement = dj_du;
    gradient.stiffness_kpa = Eigen::VectorXd::Zero(model.materials.size());
    for (Index t = 0; t < model.mesh.num_tets(); ++t) {
        const Tet& tet = model.mesh.tets[t];
        const Index region = model.mesh.region[t];
        const LinearElastic& material = model.materials[region];
        const Tet4 geometry = tet4_geometry(model.mesh.nodes[tet[0]], model.mesh.nodes[tet[1]],
                                            model.mesh.nodes[tet[2]], model.mesh.nodes[tet[3]]);
        // lambda . K_r u, and K lambda for the prescribed rows (lambda is zero there itself).
        const Corners force = tet4_stiffness(geometry, material.unit_lambda(), material.unit_mu()) *
                              at_corners(lambda, tet);
        gradient.stiffness_kpa[region] += force.dot(at_corners(u, tet));
        for (int a = 0; a < 4; ++a)
            gradient.displacement.segment<3>(3 * tet[a]) +=
                material.stiffness_kpa * force.segment<3>(3 * a);
    }
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (!model.prescribed[d]) gradient.displacement[d] = 0;
    return gradient;
}

}  // namespace palpate
