// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>

namespace palpate {

/// What a matrix, or something like the inverse of one, makes of a vector; false if it fails.
using VectorMap = std::function<bool(const Eigen::VectorXd& from, Eigen::VectorXd& to)>;

struct GmresOptions {
    double relative_tolerance = 1e-12;  ///< of |b - A x| / |b|
    int restart = 30;                   ///< iterations that remember each other
    int max_iterations = 300;
};

struct GmresSummary {
    double relative_residual = 0;  ///< |b - A x| / |b| as it is, not as the recurrence has it
    int iterations = 0;
};

/// x with A x = b, A not symmetric, from x = 0, by flexible GMRES with restarts (Saad 1993,
/// algorithm 2.2): `precondition` may answer differently each time, and so be a solve by other
/// iterations. With the symmetric part S of A as preconditioner, A = S + N, the eigenvalues of
/// S^-1 A are 1 + i sigma, and the residual falls by sigma / (1 + sqrt(1 + sigma^2)) an iteration:
/// where N is small it is hardly more than a solve with S. Stops early where a restart gains
/// nothing or a map fails.
GmresSummary flexible_gmres(const VectorMap& times, const VectorMap& precondition,
                            const Eigen::VectorXd& b, const GmresOptions& options,
                            Eigen::VectorXd& x);

}  // namespace palpate
