// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "solver/base/error.hpp"

namespace palpate {

double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return values.empty() ? std::numeric_limits<double>::quiet_NaN() : sum / double(values.size());
}

double median_of(std::vector<double> values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

std::array<double, 2> binomial_range(std::size_t hits, std::size_t trials) {
    using Binomial = boost::math::binomial_distribution<>;
    constexpr double tail = 0.025;
    std::array<double, 2> range{0, 1};
    if (hits > 0) range[0] = Binomial::find_lower_bound_on_p(double(trials), double(hits), tail);
    if (hits < trials)
        range[1] = Binomial::find_upper_bound_on_p(double(trials), double(hits), tail);
    return range;
}

std::array<double, 2> deviation_range(double rms, std::size_t count) {
    if (count == 0) return {0, std::numeric_limits<double>::infinity()};
    const boost::math::chi_squared squares(static_cast<double>(count));
    const double sum = double(count) * rms * rms;
    return {std::sqrt(sum / quantile(squares, 0.975)), std::sqrt(sum / quantile(squares, 0.025))};
}

PairedTest paired_t_test(const std::vector<double>& a, const std::vector<double>& b) {
    if (a.size() != b.size() || a.size() < 2)
        throw Error(ErrorCode::invalid_argument,
                    "A paired test needs two or more pairs of values.");
    std::vector<double> difference(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) difference[k] = a[k] - b[k];
    PairedTest test;
    test.mean_difference = mean_of(difference);
    double squares = 0;
    for (const double d : difference) squares += std::pow(d - test.mean_difference, 2);
    const double count = double(a.size());
    const double standard_error = std::sqrt(squares / (count - 1) / count);
    test.interval = {test.mean_difference, test.mean_difference};
    if (!std::isfinite(standard_error)) {
        test.p = std::numeric_limits<double>::quiet_NaN();
        return test;
    }
    if (standard_error == 0) {
        test.p = test.mean_difference == 0 ? 1 : 0;
        return test;
    }
    const boost::math::students_t student(count - 1);
    const double reach = standard_error * quantile(student, 0.975);
    test.interval = {test.mean_difference - reach, test.mean_difference + reach};
    test.t = test.mean_difference / standard_error;
    test.p = 2 * cdf(complement(student, std::abs(test.t)));
    return test;
}

}  // namespace palpate
