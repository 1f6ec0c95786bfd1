// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/case_states.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <random>

#include "host/cohort/patient.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr char converged_word = '+', not_converged_word = '-';

std::uint64_t hash_of_case(std::string_view patient, std::string_view case_id) {
    std::string both(patient);
    both += '\t';  // is in no name
    both += case_id;
    return std::hash<std::string>{}(both);
}

/// The text up to the next space, which is taken away with it.
std::string_view next_word(std::string_view& line) {
    const std::size_t end = line.find(' ');
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end == std::string_view::npos ? line.size() : end + 1);
    return word;
}

/// A line without its inode: "+ KEY PATIENT CASE {...}".
struct JournalRow {
    std::string_view sign, key, patient, case_id, record;
};
std::optional<JournalRow> journal_row(std::string_view line) {
    JournalRow row;
    for (std::string_view JournalRow::*word :
         {&JournalRow::sign, &JournalRow::key, &JournalRow::patient, &JournalRow::case_id})
        row.*word = next_word(line);
    row.record = line;
    if (row.sign.size() != 1 || !line.starts_with('{') || !line.ends_with('}')) return std::nullopt;
    return row;
}

/// A record that names another case or key than its row is not that of the row.
bool belongs_together(const CaseRecord& record, const CohortPatient& patient, const CohortCase& c) {
    return record.patient == patient.id && record.case_id == c.id && record.key == c.key;
}

std::vector<std::pair<std::string, std::uint64_t>> entries_in(const fs::path& folder) {
    std::vector<std::pair<std::string, std::uint64_t>> found;
    DIR* open = ::opendir(folder.c_str());
    if (!open) return found;
    while (const dirent* entry = ::readdir(open))
        if (entry->d_name[0] != '.') found.emplace_back(entry->d_name, entry->d_ino);
    ::closedir(open);
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace

Journals::Journals(const CohortFolder& folder) {
    for (const auto& [name, inode] : entries_in(folder.path() / "journal"))
        map(folder.path() / "journal" / name);
    std::stable_sort(entries_.begin(), entries_.end());
}

Journals::~Journals() {
    for (const auto& [data, size] : maps_) ::munmap(data, size);
}

void Journals::map(const fs::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return;
    struct stat status {};
    const bool has_text = ::fstat(file, &status) == 0 && status.st_size > 0;
    const auto size = static_cast<std::size_t>(status.st_size);
    void* data = has_text ? ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0) : MAP_FAILED;
    ::close(file);
    if (data == MAP_FAILED) return;
    maps_.emplace_back(data, size);
    std::string_view text(static_cast<const char*>(data), size);
    for (std::size_t end; (end = text.find('\n')) != std::string_view::npos;
         text.remove_prefix(end + 1)) {
        std::string_view line = text.substr(0, end);
        const std::string_view number = next_word(line);
        std::uint64_t inode = 0;
        std::from_chars(number.data(), number.data() + number.size(), inode);
        const auto row = journal_row(line);
        if (inode != 0 && row)
            entries_.push_back({hash_of_case(row->patient, row->case_id), inode, line});
    }
}

std::optional<Journals::Row> Journals::find(const std::string& patient, const std::string& case_id,
                                            std::uint64_t inode) const {
    const Entry wanted{hash_of_case(patient, case_id), inode, {}};
    auto at = std::lower_bound(entries_.begin(), entries_.end(), wanted);
    std::optional<Row> found;
    for (; at != entries_.end() && at->name == wanted.name && at->inode == inode; ++at) {
        const JournalRow row = *journal_row(at->line);
        if (row.patient != patient || row.case_id != case_id) continue;
        if (found && found->key != row.key) return std::nullopt;  // an inode was used again
        found = Row{row.sign[0] == converged_word, row.key, row.record};
    }
    return found;
}

CaseStates::CaseStates(const CohortFolder& folder) : folder_(folder), journals_(folder) {
    for (const auto& [digits, inode] : entries_in(folder.path() / "failed"))
        for (const auto& [name, of_file] : entries_in(folder.path() / "failed" / digits))
            failures_.insert(name);
}

bool CaseStates::may_have_failed(const CohortPatient& patient, const CohortCase& c) const {
    return !failures_.empty() && failures_.count(fmt::format("{}_{}.json", patient.id, c.id)) > 0;
}

std::vector<CaseState> CaseStates::of(const CohortPatient& patient, bool with_records) const {
    const auto there = entries_in(folder_.patient_folder(patient));
    std::vector<CaseState> states(patient.cases.size());
    for (std::size_t k = 0; k < states.size(); ++k) {
        const CohortCase& c = patient.cases[k];
        const auto at =
            std::lower_bound(there.begin(), there.end(), std::pair{c.id, std::uint64_t{0}});
        const auto found = at != there.end() && at->first == c.id ? at : there.end();
        if (!c.excluded.empty()) {
            states[k].status = CaseStatus::excluded;
            continue;
        }
        if (found == there.end()) {
            if (may_have_failed(patient, c)) states[k] = folder_.state_of(patient, c);
            continue;
        }
        const auto noted = journals_.find(patient.id, c.id, found->second);
        if (!noted || noted->key != c.key) {
            states[k] = folder_.state_of(patient, c);
            continue;
        }
        states[k].status = noted->converged ? CaseStatus::done : CaseStatus::not_converged;
        if (!with_records) continue;
        states[k].record = record_of(std::string(noted->record));
        if (!states[k].record || !belongs_together(*states[k].record, patient, c))
            states[k] = folder_.state_of(patient, c);
    }
    return states;
}

JournalFile::JournalFile(const CohortFolder& folder)
    : path_(folder.path() / "journal" /
            fmt::format("{}-{}-{:08x}.rows", host_name(), ::getpid(), std::random_device()())) {}

JournalFile::~JournalFile() {
    if (file_ >= 0) ::close(file_);
}

void JournalFile::add(const CaseRecord& record, std::uint64_t inode) {
    if (file_ < 0) file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    const std::string line = fmt::format(
        "{} {} {} {} {} {}\n", inode, record.converged ? converged_word : not_converged_word,
        record.key, record.patient, record.case_id, record_line(record));
    const ssize_t ignored = ::write(file_, line.data(), line.size());
    (void)ignored;
}

std::uint64_t inode_of(const fs::path& folder) {
    struct stat status {};
    return ::stat(folder.c_str(), &status) == 0 ? status.st_ino : 0;
}

}  // namespace palpate
