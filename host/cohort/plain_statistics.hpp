// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace palpate {

/// Arithmetic mean, standard deviation over n - 1 and median; NaN where there are too few.
struct PlainStatistics {
    double mean, sd, median;
};
PlainStatistics plain_statistics(std::vector<double> values);

}  // namespace palpate
