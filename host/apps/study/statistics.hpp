// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace palpate {

/// NaN for no values.
double mean_of(const std::vector<double>& values);
double median_of(std::vector<double> values);

/// 95 % range of a probability after `hits` of `trials` (Clopper and Pearson 1934): {0, 1} for no
/// trials.
std::array<double, 2> binomial_range(std::size_t hits, std::size_t trials);

/// 95 % range of a normal distribution's deviation whose `count` values about a known mean have the
/// root mean square `rms`: {0, infinity} for none.
std::array<double, 2> deviation_range(double rms, std::size_t count);

struct PairedTest {
    double mean_difference = 0;            ///< of a - b
    std::array<double, 2> interval{0, 0};  ///< 95 %
    double t = 0;
    double p = 1;  ///< two-sided
};

/// Student's t-test of the differences a - b; two or more pairs. Without any scatter p is 0 or 1,
/// with values that are not finite it is NaN.
/// Throws Error(invalid_argument) for fewer pairs or unequal sizes.
PairedTest paired_t_test(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace palpate
