// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// Turns solves with a matrix S into solves with S + E N E^T, where N is small and stands at a few
/// rows and columns (Woodbury; Golub and Van Loan 2013, section 2.1.4):
///   x = y - Z (I + N E^T Z)^-1 N E^T y,    y = S^-1 r,   Z = S^-1 E.
class LowRankUpdate {
public:
    /// Without any N.
    LowRankUpdate() = default;
    ///   rows    [k] of E N E^T that are not zero
    ///   n       [k, k]
    ///   solved  [num_dofs, k] Z
    LowRankUpdate(std::vector<Index> rows, const Eigen::MatrixXd& n, Eigen::MatrixXd solved);

    /// From y to x in place, [num_dofs, columns]; `is_negative`: with S - E N E^T, which for an
    /// antisymmetric N is the transpose.
    void apply(bool is_negative, Eigen::Ref<Eigen::MatrixXd> y) const;

private:
    std::vector<Index> rows_;
    Eigen::MatrixXd solved_;
    std::array<Eigen::MatrixXd, 2> small_;  ///< (I + N E^T Z)^-1 N, and the same for -N
};

}  // namespace palpate
