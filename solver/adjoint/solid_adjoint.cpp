// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/solid_adjoint.hpp"

#include "solver/base/error.hpp"

namespace palpate {

void check_gradient_input(const SolidAssembly& solid, const Equilibrium& found, Eigen::Index rows) {
    if (found.displacement.size() != solid.model().num_dofs() || rows != found.displacement.size())
        throw Error(ErrorCode::invalid_argument,
                    "a displacement and the slope of an objective need 3 numbers per node: " +
                        std::to_string(solid.model().num_dofs()));
    if (!found.tangent)
        throw Error(ErrorCode::unsupported,
                    "this gradient needs the equilibrium as solve_equilibrium gives it; states of "
                    "solve_history have history_gradient");
}

SolidGradient solid_gradient(const SolidAssembly& solid, const Equilibrium& found,
                             const Eigen::VectorXd& dj_du) {
    check_gradient_input(solid, found, dj_du.size());
    const Eigen::VectorXd& u = found.displacement;
    TangentSolve& tangent = *found.tangent;
    Eigen::VectorXd lambda;
    if (!tangent.solve_at(u, dj_du, lambda))
        throw Error(ErrorCode::solve_failed, no_gradient_where_unstable);
    SolidGradient gradient;
    gradient.parameters = solid.parameter_products(u, lambda);
    for (auto& material : gradient.parameters)
        for (double& value : material) value = -value;
    gradient.force = lambda;
    gradient.pressure_kpa = tangent.pressure().products(u, lambda);
    gradient.displacement = dj_du - tangent.times(lambda);
    for (Eigen::Index d = 0; d < u.size(); ++d)
        if (!solid.model().prescribed[d]) gradient.displacement[d] = 0;
    return gradient;
}

}  // namespace palpate
