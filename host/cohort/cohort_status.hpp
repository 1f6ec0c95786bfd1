// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "host/cohort/cohort_folder.hpp"

namespace palpate {

struct CohortStatus {
    std::array<std::size_t, 6> counts{};    ///< by CaseStatus
    std::size_t patients = 0, in_work = 0;  ///< claims that somebody holds now
    std::size_t bad_rows_left_out = 0;
    std::map<std::string, std::size_t> excluded_for, failed_with;  ///< reasons, sentences

    std::size_t count(CaseStatus status) const { return counts[static_cast<std::size_t>(status)]; }
    /// 0: complete; 7: complete, with cases that failed or did not converge; 9: not complete.
    int exit_code() const;
};

/// Counts from the folder; asks no engine and no other process.
CohortStatus cohort_status(const std::filesystem::path& folder);
std::string status_text(const CohortStatus& status);
std::string status_json(const CohortStatus& status);

/// Counts one case into `status`.
void add_to(CohortStatus& status, const CohortCase& c, const CaseState& state);

}  // namespace palpate
