// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// What a case folder holds.
enum class KeptFiles {
    table,    ///< result.json
    compact,  ///< and the motion of the nodes and the walls' forces, their mesh once a patient
    all,      ///< the whole result folder of `recover`
};
const char* name_of(KeptFiles keep);
/// Throws Error(invalid_argument) naming the words that are allowed.
KeptFiles kept_files_of(std::string_view word);

/// A pair of images: the unit of results.
struct CohortCase {
    std::string id;           ///< of the table, else `target_name`; names its folder
    std::string target_name;  ///< "target-04", in the table's order
    std::string session_id;
    std::string target;  ///< file
    std::string target_sha256, key;
    std::string excluded;  ///< why it is not computed; empty: it is
};

/// Pairs that share reference, settings and alignment: the unit of work.
struct CohortPatient {
    std::string id;  ///< participant, for a further reference with "_ref-02"; names its folder
    std::string participant_id;
    std::string reference_name;  ///< "ref-01"
    std::string reference;       ///< file
    std::string reference_sha256;
    std::string config;             ///< name in the folder `settings`, without ending
    std::string align;              ///< as the option of recover; empty: as for all
    std::string initial_transform;  ///< file; empty: none
    double estimate_s = 0;          ///< core seconds of all its pairs
    std::vector<CohortCase> cases = {};
};

struct CohortLimits {
    double target_s = 0;      ///< for one target, or for the reference; 0: ten times the estimate
    int attempts = 3;         ///< of a pair whose process crashes or hangs
    double memory_mb = 4000;  ///< resident, of a patient's process and what it starts
};

/// What holds for all of a cohort.
struct PlanHead {
    KeptFiles keep = KeptFiles::compact;
    std::string recover_toml;  ///< options of recover for all cases, as settings text
    CohortLimits limits;
    double shard_minutes = 30;
    std::vector<std::string> slurm_lines;  ///< for the header of engines/slurm.sh
    std::size_t num_bad_rows = 0;          ///< left out of it
    /// For tests of `run`: nothing is computed, each case sleeps so many seconds.
    std::optional<double> test_stub_s;
};

/// A whole plan in memory, as it is made.
struct CohortPlan : PlanHead {
    std::vector<CohortPatient> patients = {};

    std::size_t num_cases() const;  ///< that are not excluded
};

/// Core seconds: for a reference, and for each of its targets (docs/performance.md).
inline constexpr double reference_estimate_s = 11, target_estimate_s = 10;

/// Seconds that a target, or the reference, may take.
double limit_s(const PlanHead& plan);

/// Writes or replaces a text file, in one step.
void replace_text(const std::filesystem::path& path, const std::string& text);
/// Throws Error(input_unreadable) naming the file.
std::string text_of_file(const std::filesystem::path& path);

}  // namespace palpate
