// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/plain_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {

PlainStatistics plain_statistics(std::vector<double> values) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    PlainStatistics result{none, none, none};
    if (values.empty()) return result;
    const double n = double(values.size());
    double sum = 0, squares = 0;
    for (const double value : values) sum += value;
    result.mean = sum / n;
    for (const double value : values) squares += (value - result.mean) * (value - result.mean);
    if (values.size() > 1) result.sd = std::sqrt(squares / (n - 1));
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    result.median = values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
    return result;
}

}  // namespace palpate
