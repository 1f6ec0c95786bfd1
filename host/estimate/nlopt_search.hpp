// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace palpate {

/// Of both searches below.
struct NloptOptions {
    double lower = 0, upper = 1;  ///< bounds of every unknown
    double first_step = 0.1;      ///< radius of the first quadratic
    double tolerance = 1e-3;      ///< the search ends when it would change unknowns by less
    int max_evaluations = 100;
};

struct NloptMinimum {
    Eigen::VectorXd x;  ///< the lowest point that was evaluated
    double value = 0;
    int evaluations = 0;
    bool converged = false;  ///< whether the search ended by its tolerance
};

/// Which of NLopt's searches without derivatives.
enum class NloptSearch : std::uint8_t { bobyqa, nelder_mead };

/// The lowest point that such a search finds; exceptions of `function` come through, a value that
/// is not finite throws Error(solve_failed).
NloptMinimum minimise_with_nlopt(NloptSearch search,
                                 const std::function<double(const Eigen::VectorXd&)>& function,
                                 const Eigen::VectorXd& start, const NloptOptions& options);

}  // namespace palpate
