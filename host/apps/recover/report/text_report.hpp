// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// The result as tables for a terminal: regions with stiffness, 95 % interval and verdict; surfaces
/// with Dice and distances (mm) before and after; warnings; how the search ended. Columns are
/// aligned, names that hold control characters are made harmless. Ends with a newline.
std::string text_report(const RecoveryResult& result);

/// One line per iteration: iteration, objective, gradient_norm, step, stiffness_kpa_<region>...
/// Values that are not finite are left empty.
std::string convergence_csv(const RecoveryResult& result);

}  // namespace palpate
