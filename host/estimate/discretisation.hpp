// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/estimate/identified.hpp"

namespace palpate {

/// How far the minimum of F moves if the model is solved on a finer discretisation, to first order
/// with the columns of the coarse one, [num_parameter] on the transformed scale:
///   delta = -H^-1 J^T C^-1 (y_fine - y).
/// `finer` is predicted at the values of the fit, row by row as there. Throws Error(internal) where
/// rows do not fit.
///   coarser   what y is; the fit's, or another pair's, of the same rows and values
Eigen::VectorXd shift_by_discretisation(const std::vector<Parameter>& parameters, const Fit& fit,
                                        const Prediction& finer, const Prediction& coarser);
inline Eigen::VectorXd shift_by_discretisation(const std::vector<Parameter>& parameters,
                                               const Fit& fit, const Prediction& finer) {
    return shift_by_discretisation(parameters, fit, finer, *fit.prediction);
}

/// Takes errors of the discretisation out of values and intervals. Each of `shifts` is of one thing
/// halved (cells, time steps). With errors of order p all of the error is delta / (1 - 2^-p): 4/3
/// of delta for p = 2, twice delta for p = 1 (Richardson). Values move by 4/3 of the sum. What is
/// not known joins the intervals in quadrature: a third of each delta, for the order, and up to all
/// of it where 4/3 of their sum, or of their root of squares, is three sd and more, because then
/// more than the first order counts, whatever their signs. Verdicts follow the new intervals. What
/// is not identifiable keeps its value and its interval.
///   model_sd   [num_parameter] of what else a model has wrong, of logarithms: joins the intervals
///              of what is searched for as one and is no nuisance; empty: nothing
void correct_for_discretisation(const std::vector<Eigen::VectorXd>& shifts, const Fit& fit,
                                Identified& all, const Eigen::VectorXd& model_sd = {});

}  // namespace palpate
