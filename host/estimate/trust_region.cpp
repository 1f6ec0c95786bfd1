// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/trust_region.hpp"

namespace palpate {

NloptMinimum minimise_in_trust_region(const std::function<double(const Eigen::VectorXd&)>& function,
                                      const Eigen::VectorXd& start, const NloptOptions& options) {
    return minimise_with_nlopt(NloptSearch::bobyqa, function, start, options);
}

}  // namespace palpate
