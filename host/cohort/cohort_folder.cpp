// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/cohort_folder.hpp"

#include <fmt/core.h>

#include <array>
#include <fstream>

#include "host/cohort/content_key.hpp"
#include "host/io/output_folder.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::array<const char*, 6> words_of_status{"done",  "not converged", "failed",
                                                     "stale", "waiting",       "excluded"};

/// Two digits, so that no folder holds too many.
std::string two_digits(const CohortPatient& patient) { return sha256_of(patient.id).substr(0, 2); }

std::string whole_text(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

CaseState state_of_record(std::optional<CaseRecord> record, const std::string& key) {
    CaseState state;
    state.status = record->key != key  ? CaseStatus::stale
                   : record->converged ? CaseStatus::done
                                       : CaseStatus::not_converged;
    state.record = std::move(record);
    return state;
}

/// Of a case without a result of its key.
CaseState without_result(const CohortFolder& folder, const CohortPatient& patient,
                         const CohortCase& c, CaseState state) {
    auto failure = failure_of(whole_text(folder.failure_file(patient, c)));
    if (!failure || failure->key != c.key) return state;
    return {CaseStatus::failed, std::nullopt, std::move(failure)};
}

}  // namespace

const char* name_of(CaseStatus status) {
    return words_of_status.at(static_cast<std::size_t>(status));
}

fs::path CohortFolder::settings_file(const std::string& config) const {
    return folder_ / "settings" / (config + ".toml");
}
fs::path CohortFolder::patient_folder(const CohortPatient& patient) const {
    return folder_ / "cases" / two_digits(patient) / patient.id;
}
fs::path CohortFolder::case_folder(const CohortPatient& patient, const CohortCase& c) const {
    return patient_folder(patient) / c.id;
}
fs::path CohortFolder::failure_file(const CohortPatient& patient, const CohortCase& c) const {
    return folder_ / "failed" / two_digits(patient) / fmt::format("{}_{}.json", patient.id, c.id);
}
fs::path CohortFolder::claim_file(const CohortPatient& patient) const {
    return folder_ / "cases" / two_digits(patient) / fmt::format(".{}.claim", patient.id);
}
fs::path CohortFolder::log_file(const CohortPatient& patient) const {
    return folder_ / "logs" / two_digits(patient) / (patient.id + ".txt");
}

void CohortFolder::make_place_of(const CohortPatient& patient) const {
    make_folders(claim_file(patient).parent_path());
    make_folders(log_file(patient).parent_path());
}

CaseState CohortFolder::state_of(const CohortPatient& patient, const CohortCase& c) const {
    if (!c.excluded.empty()) return {CaseStatus::excluded, std::nullopt, std::nullopt};
    CaseState state;
    if (auto record = record_of(whole_text(case_folder(patient, c) / case_record_name)))
        state = state_of_record(std::move(record), c.key);
    if (state.status == CaseStatus::done || state.status == CaseStatus::not_converged) return state;
    return without_result(*this, patient, c, std::move(state));
}

}  // namespace palpate
