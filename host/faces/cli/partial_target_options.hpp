// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host/apps/recover/pipeline/recover.hpp"

namespace palpate {

/// A target of surfaces and points, as the user typed it.
struct PartialTargetArguments {
    std::vector<std::string> surfaces, points;  ///< ORGAN=FILE
    std::string frame = "lps";
    double noise_mm = PartialTarget{}.noise_mm;
};

/// To be called after the option "target" was added.
void add_partial_target_options(CLI::App& command, PartialTargetArguments& arguments);

bool has_shapes(const PartialTargetArguments& arguments);

/// Throws Error(invalid_argument) unless there are either label volumes or surfaces and points.
void check_one_kind_of_target(const std::vector<std::string>& label_volumes,
                              const PartialTargetArguments& arguments);

/// Reads the files. Throws Error(invalid_argument) for what is not ORGAN=FILE, and what reading
/// throws.
PartialTarget partial_target(const PartialTargetArguments& arguments);

}  // namespace palpate
