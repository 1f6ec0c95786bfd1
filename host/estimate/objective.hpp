// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// One unknown of an estimate with its Gaussian prior, on the scale on which it is searched (ln E
/// of a modulus in kPa).
struct Unknown {
    Index object = 0;  ///< whose it is: the region of a modulus
    double mean = 0;
    double sd = 1;
};

/// What a search minimises: minus the log posterior F of the unknowns theta, up to a constant, all
/// else integrated out.
class Objective {
public:
    struct Evaluation {
        double objective = 0;  ///< F
        double log_determinant =
            0;                     ///< twice the part of F that integrating out has left, ln det C
        Eigen::VectorXd gradient;  ///< dF/dtheta [num_unknown], zero if not asked for
    };

    virtual ~Objective() = default;
    virtual Evaluation evaluate(const Eigen::VectorXd& theta, bool with_gradient) const = 0;
    /// F alone at several theta.
    virtual std::vector<double> objectives(const std::vector<Eigen::VectorXd>& thetas) const = 0;
    /// Of F [num_unknown, num_unknown], symmetric.
    virtual Eigen::MatrixXd hessian(const Eigen::VectorXd& theta) const = 0;
    /// What is seen says of theta [num_unknown, num_unknown]: the Fisher information of the mean of
    /// the data. It is a part of the curvature of F; the other part rests on the spread of what
    /// nobody saw, that is on a prior.
    virtual Eigen::MatrixXd seen_information(const Eigen::VectorXd& theta) const = 0;
    virtual const std::vector<Unknown>& unknowns() const = 0;
    Index num_unknown() const { return static_cast<Index>(unknowns().size()); }
};

/// The priors' part of F: sum of ((theta - mean) / sd)^2 / 2.
double prior_energy(const std::vector<Unknown>& unknowns, const Eigen::VectorXd& theta);

/// F less the priors' part: minus the log likelihood.
std::vector<double> misfits(const Objective& problem, const std::vector<Eigen::VectorXd>& thetas);

}  // namespace palpate
