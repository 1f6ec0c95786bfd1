// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/cohort/cohort_plan.hpp"
#include "host/io/delimited_text.hpp"
#include "solver/base/log.hpp"

namespace palpate {

struct PlanRequest {
    std::filesystem::path table;     ///< .tsv or .csv
    std::filesystem::path config;    ///< cohort.toml, or empty
    std::filesystem::path settings;  ///< organs of the rows that name none, or empty
    std::filesystem::path root;      ///< of relative paths; empty: the table's folder
    std::optional<KeptFiles> keep;
    bool check_voxels = false;  ///< inflate every volume, not only its header
    std::optional<double> test_stub_s;
};

/// What planning finds: a plan of the good rows, and all faults.
struct PlannedCohort {
    CohortPlan plan;
    std::vector<TableFault> faults;
    /// Name in the folder `settings`, and TOML.
    std::vector<std::pair<std::string, std::string>> settings;
};

/// Reads the table, checks every row and hashes every input. `hashes` is a file of hashes that were
/// computed before, by path, size, time of change and inode; read and written anew. Throws
/// Error(input_unreadable) if the table cannot be read, what reading `config` throws, and what the
/// sink throws.
PlannedCohort make_cohort_plan(const PlanRequest& request, const std::filesystem::path& hashes,
                               const ProgressSink& progress);

/// Throws Error(output_failed) if `folder` is no place for a cohort: it holds something else, or a
/// plan that may not be replaced.
void check_cohort_folder(const std::filesystem::path& folder, bool overwrite);

/// Writes problems.tsv and, unless there are faults that may not be skipped, the plan in place of
/// an older one. Throws Error(input_unusable) naming problems.tsv then, Error(output_failed), also
/// if disk or inodes do not suffice.
void write_planned(const PlannedCohort& planned, const std::filesystem::path& folder,
                   bool skip_bad);

}  // namespace palpate
