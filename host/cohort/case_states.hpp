// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "host/cohort/cohort_folder.hpp"

namespace palpate {

/// What the runners noted when cases were done: a cache of case.json, for speed. A row counts only
/// for a folder of the same inode, and only if no other row names that folder with another key.
/// The files stay on disk and are mapped, not read.
class Journals {
public:
    /// Lines that are torn or of another version are left out.
    explicit Journals(const CohortFolder& folder);
    ~Journals();
    Journals(const Journals&) = delete;
    Journals& operator=(const Journals&) = delete;

    struct Row {
        bool converged = false;
        std::string_view key, record;  ///< as `record_of` takes it
    };
    /// Of the folder of that case with this inode; empty if no row can be trusted.
    std::optional<Row> find(const std::string& patient, const std::string& case_id,
                            std::uint64_t inode) const;

private:
    struct Entry {
        std::uint64_t name = 0;  ///< hash of patient and case
        std::uint64_t inode = 0;
        std::string_view line;  ///< after the inode
        /// By inode first: cases of a patient lie side by side, as they are asked for.
        bool operator<(const Entry& other) const {
            return inode != other.inode ? inode < other.inode : name < other.name;
        }
    };
    void map(const std::filesystem::path& file);

    std::vector<std::pair<void*, std::size_t>> maps_;
    std::vector<Entry> entries_;
};

/// How far all cases of a cohort are, with few looks at the disk.
class CaseStates {
public:
    explicit CaseStates(const CohortFolder& folder);
    /// Of all cases of a patient, in the plan's order. Without `with_records` those that are done
    /// have none, if a journal has them.
    std::vector<CaseState> of(const CohortPatient& patient, bool with_records) const;

private:
    bool may_have_failed(const CohortPatient& patient, const CohortCase& c) const;

    const CohortFolder& folder_;
    Journals journals_;
    std::unordered_set<std::string> failures_;  ///< names of failure files
};

/// The journal of one runner. Appends, so that lines of a process that is killed are torn at most
/// at their end.
class JournalFile {
public:
    explicit JournalFile(const CohortFolder& folder);
    ~JournalFile();
    JournalFile(const JournalFile&) = delete;
    JournalFile& operator=(const JournalFile&) = delete;
    /// Notes a case whose folder has that inode. What cannot be written is left out: a cache.
    void add(const CaseRecord& record, std::uint64_t inode);

private:
    std::filesystem::path path_;
    int file_ = -1;
};

/// 0 if there is no such folder.
std::uint64_t inode_of(const std::filesystem::path& folder);

}  // namespace palpate
