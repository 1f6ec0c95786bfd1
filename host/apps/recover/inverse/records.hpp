// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// The objective along ln E of one unknown modulus, other unknowns following.
struct ProfileResult {
    Index region = 0;
    std::vector<double> stiffness_kpa;
    std::vector<double> objective;  ///< minus its minimum: 1.92 is the 95 % line
};

struct IterationRecord {
    int iteration = 0;
    double objective = 0;
    double gradient_norm = 0;  ///< scaled by the posterior sd
    double step = 0;
    std::vector<double> stiffness_kpa;  ///< unknown moduli, in region order
};

/// Adds what a later search did; iterations count on.
inline void append_records(std::vector<IterationRecord>& records,
                           const std::vector<IterationRecord>& later) {
    for (IterationRecord record : later) {
        record.iteration = static_cast<int>(records.size()) + 1;
        records.push_back(std::move(record));
    }
}

struct Termination {
    bool converged = false;
    std::string reason;
    int iterations = 0;
};

}  // namespace palpate
