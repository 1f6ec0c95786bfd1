// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace palpate {

/// sd of a Gaussian over the median of its absolute values.
inline constexpr double sd_over_mad = 1.4826;

/// The median, of [at least one] numbers.
inline double middle_of(Eigen::VectorXd values) {
    const auto middle = values.begin() + values.size() / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace palpate
