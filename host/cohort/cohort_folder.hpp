// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "host/cohort/case_record.hpp"
#include "host/cohort/cohort_plan.hpp"

namespace palpate {

/// How far a case is. Truth, in this order: a case folder with the plan's key, a failure file with
/// it, nothing.
enum class CaseStatus { done, not_converged, failed, stale, waiting, excluded };
const char* name_of(CaseStatus status);

struct CaseState {
    CaseStatus status = CaseStatus::waiting;
    std::optional<CaseRecord> record;      ///< of done, not_converged and stale
    std::optional<FailureRecord> failure;  ///< of failed
};

/// Where things are in the folder of a cohort.
class CohortFolder {
public:
    explicit CohortFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

    const std::filesystem::path& path() const { return folder_; }
    std::filesystem::path settings_file(const std::string& config) const;
    std::filesystem::path patient_folder(const CohortPatient& patient) const;
    std::filesystem::path case_folder(const CohortPatient& patient, const CohortCase& c) const;
    std::filesystem::path failure_file(const CohortPatient& patient, const CohortCase& c) const;
    std::filesystem::path claim_file(const CohortPatient& patient) const;
    std::filesystem::path log_file(const CohortPatient& patient) const;
    /// Makes the folder in which the patient's claim and folder are.
    void make_place_of(const CohortPatient& patient) const;

    CaseState state_of(const CohortPatient& patient, const CohortCase& c) const;

private:
    std::filesystem::path folder_;
};

}  // namespace palpate
