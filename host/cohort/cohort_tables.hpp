// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/cohort/cohort_folder.hpp"
#include "host/cohort/plain_statistics.hpp"

namespace palpate {

/// A row of patients.tsv: one region of one reference.
struct PatientRegion {
    std::string participant_id, reference, region;
    std::size_t pairs = 0, done = 0, failed = 0, identified = 0;
    PlainStatistics kpa{}, ln_e{};  ///< of the pairs that were identified and not rejected
};

/// Header lines, and what the columns mean, as JSON.
std::string pairs_header();
std::string patients_header();
std::string pairs_dictionary();
std::string patients_dictionary();

/// The rows of a case: one for each region, or one without.
std::string pair_rows(const CohortPatient& patient, const CohortCase& c, const CaseState& state,
                      CaseFlags flags, const std::string& rating);
std::string patient_row(const PatientRegion& region);

}  // namespace palpate
