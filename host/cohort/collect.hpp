// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/cohort/cohort_status.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// All modulus estimates of one region of a patient.
struct PatientRegion {
    const CohortPatient* patient = nullptr;
    std::string region;
    std::size_t pairs = 0, done = 0, failed = 0;
    std::vector<std::pair<std::string, RegionRecord>> found = {};  ///< by target

    std::vector<double> identified_kpa() const;
};

/// Arithmetic mean, standard deviation over n - 1 and median; NaN where there are too few.
struct PlainStatistics {
    double mean, sd, median;
};
PlainStatistics plain_statistics(std::vector<double> values);

/// Writes pairs.tsv, patients.tsv, their descriptions (.json), dataset_description.json and
/// index.html into the folder of a cohort, from case folders alone. Throws Error(input_unusable) if
/// results of other settings or inputs are among them and `mixed` is false.
CohortStatus collect_cohort(const std::filesystem::path& folder, bool mixed,
                            const ProgressSink& progress);

/// The page of a cohort.
std::string cohort_page(const CohortStatus& status, const std::vector<PatientRegion>& regions);

}  // namespace palpate
