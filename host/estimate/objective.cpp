// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/objective.hpp"

#include <cmath>

namespace palpate {

double prior_energy(const std::vector<Unknown>& unknowns, const Eigen::VectorXd& theta) {
    double sum = 0;
    for (std::size_t k = 0; k < unknowns.size(); ++k)
        sum += 0.5 * std::pow((theta[k] - unknowns[k].mean) / unknowns[k].sd, 2);
    return sum;
}

std::vector<double> misfits(const Objective& problem, const std::vector<Eigen::VectorXd>& thetas) {
    std::vector<double> values = problem.objectives(thetas);
    for (std::size_t p = 0; p < thetas.size(); ++p)
        values[p] -= prior_energy(problem.unknowns(), thetas[p]);
    return values;
}

}  // namespace palpate
