// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/cohort_folder.hpp"

#include <dirent.h>
#include <fmt/core.h>
#include <sys/stat.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

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

std::map<std::string, std::uint64_t> inodes_in(const fs::path& folder) {
    std::map<std::string, std::uint64_t> found;
    DIR* open = ::opendir(folder.c_str());
    if (!open) return found;
    while (const dirent* entry = ::readdir(open))
        if (entry->d_name[0] != '.') found.emplace(entry->d_name, entry->d_ino);
    ::closedir(open);
    return found;
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

Journals::Journals(const CohortFolder& folder) {
    std::error_code failed;
    for (const auto& file : fs::directory_iterator(folder.path() / "journal", failed)) {
        std::ifstream in(file.path(), std::ios::binary);
        for (std::string line; std::getline(in, line);) {
            const std::size_t space = line.find(' ');
            auto record =
                space == std::string::npos ? std::nullopt : record_of(line.substr(space + 1));
            if (!record) continue;
            const std::uint64_t inode = std::strtoull(line.c_str(), nullptr, 10);
            auto& rows = rows_[record->patient][record->case_id];
            const auto [found, is_new] = rows.try_emplace(inode);
            found->second.is_doubtful |= !is_new && found->second.record.key != record->key;
            found->second.record = std::move(*record);
        }
    }
}

const CaseRecord* Journals::find(const std::string& patient, const std::string& case_id,
                                 std::uint64_t inode) const {
    const auto of_patient = rows_.find(patient);
    if (of_patient == rows_.end()) return nullptr;
    const auto of_case = of_patient->second.find(case_id);
    if (of_case == of_patient->second.end()) return nullptr;
    const auto row = of_case->second.find(inode);
    if (row == of_case->second.end() || row->second.is_doubtful) return nullptr;
    return &row->second.record;
}

std::vector<CaseState> states_of(const CohortFolder& folder, const Journals& journals,
                                 const CohortPatient& patient) {
    const auto there = inodes_in(folder.patient_folder(patient));
    std::vector<CaseState> states;
    for (const CohortCase& c : patient.cases) {
        const auto found = there.find(c.id);
        const CaseRecord* noted =
            found == there.end() ? nullptr : journals.find(patient.id, c.id, found->second);
        if (noted && noted->key == c.key && c.excluded.empty())
            states.push_back(state_of_record(*noted, c.key));
        else
            states.push_back(folder.state_of(patient, c));
    }
    return states;
}

std::string journal_line(const CaseRecord& record, std::uint64_t inode) {
    return fmt::format("{} {}\n", inode, record_line(record));
}

std::uint64_t inode_of(const fs::path& folder) {
    struct stat status {};
    return ::stat(folder.c_str(), &status) == 0 ? status.st_ino : 0;
}

}  // namespace palpate
