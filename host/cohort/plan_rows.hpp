// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/io/delimited_text.hpp"

namespace palpate {

/// A row of the table of pairs, checked for its form.
struct PlanRequestRow {
    std::size_t line = 0;
    std::string participant_id, session_id, case_id, config, align, exclude;
    std::filesystem::path reference, target, initial_transform;
};

/// The rows of a table of pairs; faults are added to `table.faults`, and their rows left out.
/// `folder`: of relative paths. Ids match [A-Za-z0-9-]{1,32}.
std::vector<PlanRequestRow> plan_rows(DelimitedText& table, const std::filesystem::path& folder);

/// Whether it may name a folder: 1 to 32 letters, digits and hyphens, no hyphen first.
bool is_cohort_id(const std::string& id);

}  // namespace palpate
