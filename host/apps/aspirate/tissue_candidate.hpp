// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <string>

#include "host/apps/aspirate/fit_page.hpp"
#include "host/apps/aspirate/tissue_search.hpp"

namespace palpate {

constexpr double infinite_evidence = std::numeric_limits<double>::infinity();

/// One law with one number of relaxation terms.
struct TissueCandidate {
    std::string law;
    int num_terms = 0;
    TriedModel tried = {};
    std::unique_ptr<TissueSearch> search = nullptr;  ///< null where it has failed
    /// ln, of the first of each law; infinite where it cannot be told.
    double evidence_near = infinite_evidence, evidence_compared = infinite_evidence;
    bool can_tell = false;  ///< whether its evidence can be compared
    bool is_found = false;  ///< whether the search is at its end already
    std::exception_ptr failure = nullptr;
    std::string why_failed = "";

    /// Infinite where the search cannot tell yet: it may be the best.
    double log_evidence() const {
        const Fit& fit = tried.found->fit;
        const bool is_told = can_tell && fit.prediction && fit.ending != Ending::too_many_steps &&
                             std::isfinite(tried.found->identified.log_evidence);
        return is_told ? tried.found->identified.log_evidence : infinite_evidence;
    }
    bool is_compared() const { return search && tried.found; }
};

}  // namespace palpate
