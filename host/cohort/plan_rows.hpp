// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/delimited_text.hpp"

namespace palpate {

/// A row of the table of pairs, checked for its form.
struct PlanRequestRow {
    std::size_t line = 0;
    std::string participant_id, session_id, case_id, config, align, exclude;
    std::string reference, target, initial_transform;  ///< files
};

/// Gives `take` the rows of a table of pairs, one after the other; returns the faults, whose rows
/// are left out. `folder`: of relative paths. Ids match [A-Za-z0-9-]{1,32}.
std::vector<TableFault> for_each_plan_row(std::string_view text, const DelimitedFormat& format,
                                          const std::filesystem::path& folder,
                                          const std::function<void(PlanRequestRow& row)>& take);

/// Whether it may name a folder: 1 to 32 letters, digits and hyphens, no hyphen first.
bool is_cohort_id(const std::string& id);

}  // namespace palpate
