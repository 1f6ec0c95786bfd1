// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/simplex.hpp"

namespace palpate {

TrustRegionMinimum minimise_by_simplex(
    const std::function<double(const Eigen::VectorXd&)>& function, const Eigen::VectorXd& start,
    const TrustRegionOptions& options) {
    return minimise_with_nlopt(NloptSearch::nelder_mead, function, start, options);
}

}  // namespace palpate
