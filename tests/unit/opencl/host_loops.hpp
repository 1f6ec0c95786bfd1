// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "solver/model/model.hpp"

namespace palpate::host_loops {

/// [rows, columns], column index fastest, as the back ends have it.
using Columns = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Plain fp64 loops over the elements, written from the formulas and from nothing else: what the
/// kernels are held to. `moduli` are Young's moduli per region.
Columns internal_force(const Model& model, const std::vector<double>& moduli, const Columns& x);
Columns constrained_product(const Model& model, const std::vector<double>& moduli,
                            const Columns& x);
/// Diagonal 3x3 blocks of the constrained stiffness, inverted, times r.
Columns block_jacobi(const Model& model, const std::vector<double>& moduli, const Columns& r);

std::vector<double> moduli_of(const Model& model);
/// Reproducible numbers in [-1, 1].
Columns random_columns(Index rows, Index columns, unsigned seed);
/// Largest difference over the largest entry of `expected`.
double relative_difference(const Columns& actual, const Columns& expected);

}  // namespace palpate::host_loops
