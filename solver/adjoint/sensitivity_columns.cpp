// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/sensitivity_columns.hpp"

#include <string>

#include "solver/adjoint/solid_adjoint.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

Eigen::MatrixXd solved(const Equilibrium& found, const Eigen::MatrixXd& right, bool is_transposed) {
    Eigen::MatrixXd columns;
    if (!found.tangent->solve_columns_at(found.displacement, right, columns, is_transposed))
        throw Error(ErrorCode::solve_failed, no_gradient_where_unstable);
    return columns;
}

}  // namespace

Eigen::MatrixXd adjoint_columns(const SolidAssembly& solid, const Equilibrium& found,
                                const Eigen::MatrixXd& dj_du) {
    check_gradient_input(solid, found, dj_du.rows());
    return solved(found, dj_du, true);
}

std::vector<Eigen::MatrixXd> parameter_columns(const SolidAssembly& solid,
                                               const Equilibrium& found) {
    check_gradient_input(solid, found, found.displacement.size());
    const std::vector<Eigen::MatrixXd> forces = solid.parameter_forces(found.displacement);
    Eigen::Index count = 0;
    for (const Eigen::MatrixXd& force : forces) count += force.cols();
    Eigen::MatrixXd right(found.displacement.size(), count);
    count = 0;
    for (const Eigen::MatrixXd& force : forces) {
        right.middleCols(count, force.cols()) = -force;
        count += force.cols();
    }
    const Eigen::MatrixXd all = solved(found, right, false);
    std::vector<Eigen::MatrixXd> columns;
    count = 0;
    for (const Eigen::MatrixXd& force : forces) {
        columns.emplace_back(all.middleCols(count, force.cols()));
        count += force.cols();
    }
    return columns;
}

Eigen::MatrixXd displacement_columns(const SolidAssembly& solid, const Equilibrium& found,
                                     std::span<const Index> dofs) {
    check_gradient_input(solid, found, found.displacement.size());
    Eigen::MatrixXd moved =
        Eigen::MatrixXd::Zero(found.displacement.size(), static_cast<Eigen::Index>(dofs.size()));
    for (std::size_t k = 0; k < dofs.size(); ++k) {
        const bool is_dof = dofs[k] >= 0 && dofs[k] < solid.model().num_dofs();
        if (!is_dof || !solid.model().prescribed[dofs[k]])
            throw Error(ErrorCode::invalid_argument,
                        "degree of freedom " + std::to_string(dofs[k]) + " is not prescribed");
        moved(dofs[k], static_cast<Eigen::Index>(k)) = 1;
    }
    // A first solve leaves K in the tangent.
    solved(found, Eigen::MatrixXd::Zero(moved.rows(), 1), false);
    const Eigen::MatrixXd right = -found.tangent->times(moved);
    return moved + solved(found, right, false);
}

}  // namespace palpate
