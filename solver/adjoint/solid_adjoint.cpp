// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/adjoint/solid_adjoint.hpp"

#include "solver/base/error.hpp"

namespace palpate {

SolidGradient solid_gradient(const SolidAssembly& solid, const Equilibrium& found,
                             const Eigen::VectorXd& dj_du) {
    const Eigen::VectorXd& u = found.displacement;
    if (u.size() != solid.model().num_dofs() || dj_du.size() != u.size())
        throw Error(ErrorCode::invalid_argument,
                    "a displacement and the slope of an objective need 3 numbers per node: " +
                        std::to_string(solid.model().num_dofs()));
    if (!found.tangent)
        throw Error(ErrorCode::unsupported,
                    "a gradient needs the equilibrium as solve_equilibrium gives it; there is none "
                    "yet through a load history");
    TangentSolve& tangent = *found.tangent;
    Eigen::VectorXd lambda;
    if (!tangent.solve_at(u, dj_du, lambda))
        throw Error(ErrorCode::solve_failed,
                    "the tangent at the equilibrium is not positive definite, so its gradient is "
                    "not defined; the body is not stable there");
    SolidGradient gradient;
    gradient.parameters = solid.parameter_products(u, lambda);
    for (auto& material : gradient.parameters)
        for (double& value : material) value = -value;
    gradient.force = lambda;
    gradient.displacement = dj_du - tangent.times(lambda);
    for (Eigen::Index d = 0; d < u.size(); ++d)
        if (!solid.model().prescribed[d]) gradient.displacement[d] = 0;
    return gradient;
}

}  // namespace palpate
