// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "solver/base/log.hpp"

namespace palpate {

/// Makes the whole result folder of cases that are kept as `compact`: fields, label volumes, mesh
/// and report, as `recover` would have written them, from what was kept and the two label volumes.
/// No mesh is made and nothing is searched.
///   cases  patient/case, as folders are called; none: all that have a result
///   out    gets a folder patient/case for each; those that are there already stay
/// Returns how many were made. Throws Error(invalid_argument) for a case that the plan has not,
/// Error(input_unusable) for one without a result, kept as `table`, or whose volumes have changed,
/// Error(input_unreadable) for damaged files, Error(output_failed).
std::size_t expand_cases(const std::filesystem::path& cohort, const std::vector<std::string>& cases,
                         const std::filesystem::path& out, const ProgressSink& progress);

}  // namespace palpate
