// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/model_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {

std::size_t preferred_model(std::span<const ModelCandidate> candidates) {
    double highest = -std::numeric_limits<double>::infinity();
    for (const ModelCandidate& one : candidates) {
        if (!std::isfinite(one.log_evidence))
            throw Error(ErrorCode::invalid_argument, "a model's evidence is not a finite number");
        highest = std::max(highest, one.log_evidence);
    }
    if (candidates.empty())
        throw Error(ErrorCode::invalid_argument, "there is no model to choose from");
    std::size_t preferred = candidates.size();
    const auto rank = [&](std::size_t k) {
        return std::pair(-candidates[k].num_parameter, candidates[k].log_evidence);
    };
    for (std::size_t k = 0; k < candidates.size(); ++k)
        if (candidates[k].log_evidence > highest - bare_mention &&
            (preferred == candidates.size() || rank(k) > rank(preferred)))
            preferred = k;
    return preferred;
}

}  // namespace palpate
