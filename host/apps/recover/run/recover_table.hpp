// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/recover/pipeline/plan.hpp"
#include "host/apps/recover/pipeline/recover_options.hpp"
#include "host/io/option_values.hpp"

namespace palpate {

/// All that can be said to a recovery.
std::vector<Option> recover_table();

/// What `values` of the table mean for the search. Reads the settings, unless they are given, and
/// the landmarks. Throws what reading them throws, Error(device_unavailable).
RecoverOptions recover_options_of(const OptionValues& values);
RecoverOptions recover_options_of(const OptionValues& values, Settings settings);

/// What they mean for a plan.
PlanOptions plan_options_of(const OptionValues& values);

}  // namespace palpate
