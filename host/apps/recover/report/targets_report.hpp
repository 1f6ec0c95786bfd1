// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/apps/recover/result/joint_result.hpp"
#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// The line of the tables of all targets that is no target's.
constexpr const char* joint_row_name = "joint";

/// One of several targets of a run, as the tables of all targets list it.
struct TargetRow {
    std::string name;                   ///< of its result folder
    std::vector<RegionResult> unknown;  ///< regions whose modulus or Poisson's ratio was estimated
    bool converged = false;
    double seconds = 0;  ///< of this target alone; NaN if it failed
    std::string note;    ///< why it failed or did not converge, else empty
};

TargetRow target_row(std::string name, const RecoveryResult& result, double seconds);
/// What all targets together tell (recover_all); `names` are those of all targets.
TargetRow joint_row(JointResult result, const std::vector<std::string>& names);
TargetRow failed_row(std::string name, const std::string& message);

/// For a terminal: a line per target and unknown region, then the notes. Ends with a newline.
std::string targets_table(const std::vector<TargetRow>& rows);
/// The same for programs: target, region, stiffness_kpa, low_kpa, high_kpa, verdict, converged
/// (1 or 0), seconds, note, poisson_ratio, low_ratio, high_ratio, ratio_verdict (the last four
/// empty where no ratio was searched). A target without unknown region or without result has one
/// line.
std::string targets_csv(const std::vector<TargetRow>& rows);

/// Names of the result folders of several targets: the file's name without its ending(s), with a
/// number appended where another target has the same.
std::vector<std::string> target_folder_names(const std::vector<std::filesystem::path>& targets);
/// "target-1", "target-2", ...: names that tell nothing about the files.
std::vector<std::string> numbered_folder_names(std::size_t num_targets);

}  // namespace palpate
