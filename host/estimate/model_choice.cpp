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
    if (candidates.empty())
        throw Error(ErrorCode::invalid_argument, "there is no model to choose from");
    double highest = -std::numeric_limits<double>::infinity();
    for (const ModelCandidate& one : candidates)
        if (std::isfinite(one.log_evidence)) highest = std::max(highest, one.log_evidence);
    std::size_t preferred = candidates.size();
    const auto rank = [&](std::size_t k) {
        return std::pair(-candidates[k].num_parameter, candidates[k].log_evidence);
    };
    for (std::size_t k = 0; k < candidates.size(); ++k)
        if (std::isfinite(candidates[k].log_evidence) &&
            candidates[k].log_evidence > highest - bare_mention &&
            (preferred == candidates.size() || rank(k) > rank(preferred)))
            preferred = k;
    return preferred < candidates.size() ? preferred : 0;
}

}  // namespace palpate
