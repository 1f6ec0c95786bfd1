// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCore>

#include "host/apps/recover/modelling/build_model.hpp"

namespace palpate {

/// Precision matrix of the driven displacement before any data: each component of each organ's wall
/// motion is a Gaussian random field on that wall with the given standard deviation and range
/// (Matern, smoothness 1; Lindgren, Rue, Lindstroem 2011, eq. 10 with alpha = 2):
///   Q = tau^2 (kappa^2 C + G) C^-1 (kappa^2 C + G),  kappa = sqrt(8) / range,
///   tau^2 = 1 / (4 pi kappa^2 sd^2),
/// C the lumped mass and G the stiffness (cotangent) matrix of the wall's triangles.
/// Returns the precision of one component, [num_driven, num_driven], symmetric positive definite,
/// per mm^2. This is the first guess: where moduli are looked for, `fit_walls` replaces it.
Eigen::SparseMatrix<double> displacement_precision(const RecoveryModel& recovery, double sd_mm,
                                                   double range_mm);

}  // namespace palpate
