// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
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

/// What the runners noted when cases were done: a cache of case.json, for speed. A row counts only
/// for a folder of the same inode, and only if no other row names that folder.
class Journals {
public:
    /// Reads all of a cohort; lines that are torn or damaged are left out.
    explicit Journals(const CohortFolder& folder);
    /// Of the folder of that case with this inode; null if no row can be trusted.
    const CaseRecord* find(const std::string& patient, const std::string& case_id,
                           std::uint64_t inode) const;

private:
    struct Row {
        std::uint64_t inode = 0;
        bool is_doubtful = false;
        CaseRecord record;
    };
    std::map<std::string, std::map<std::string, std::map<std::uint64_t, Row>>> rows_;
};

/// The states of all cases of a patient, with one look at its folder; in the plan's order.
std::vector<CaseState> states_of(const CohortFolder& folder, const Journals& journals,
                                 const CohortPatient& patient);

/// The line of a journal for a record and the inode of its folder.
std::string journal_line(const CaseRecord& record, std::uint64_t inode);
/// 0 if there is no such folder.
std::uint64_t inode_of(const std::filesystem::path& folder);

}  // namespace palpate
