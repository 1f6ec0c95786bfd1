// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/recover/pipeline/partial_target.hpp"
#include "host/io/option_values.hpp"

namespace palpate {

/// Whether the target is made of surfaces and points ("target_surface", "target_points"). Throws
/// Error(invalid_argument) unless there are either these or label volumes ("target").
bool has_shapes(const OptionValues& values);

/// Reads the files. Throws Error(invalid_argument) for what is not ORGAN=FILE, and what reading
/// throws.
PartialTarget target_of_shapes(const OptionValues& values);

}  // namespace palpate
