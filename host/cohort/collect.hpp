// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "host/cohort/cohort_status.hpp"
#include "solver/base/log.hpp"

namespace palpate {

struct CollectRequest {
    std::filesystem::path cohort;
    bool mixed = false;             ///< also results of other settings or inputs
    std::filesystem::path ratings;  ///< empty: ratings.tsv of the cohort, if it is there
};

struct CollectedCohort {
    CohortStatus status;
    std::size_t unused_ratings = 0;  ///< of other results than those that are there
};

/// Writes pairs.tsv, patients.tsv, their descriptions (.json), dataset_description.json, the
/// gallery and index.html into the folder of a cohort, from case folders alone. Throws
/// Error(input_unusable) if results of other settings or inputs are among them and `mixed` is
/// false, and what reading ratings throws.
CollectedCohort collect_cohort(const CollectRequest& request, const ProgressSink& progress);

}  // namespace palpate
