// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate {

/// A nonlinear regression y = f(x; b) whose least squares are certified to 11 digits.
struct NistData {
    std::string name;
    std::vector<double> first_start, second_start;  ///< far and near
    std::vector<double> certified, certified_sd;    ///< of the parameters
    double residual_sum_of_squares, residual_sd;
    std::vector<double> x, y;
};

const std::vector<NistData>& nist_data();

}  // namespace palpate
