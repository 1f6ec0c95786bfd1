// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/simplex.hpp"

namespace palpate {

NloptMinimum minimise_by_simplex(const std::function<double(const Eigen::VectorXd&)>& function,
                                 const Eigen::VectorXd& start, const NloptOptions& options) {
    return minimise_with_nlopt(NloptSearch::nelder_mead, function, start, options);
}

}  // namespace palpate
