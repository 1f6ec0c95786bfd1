// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// `palpate aspirate plan`: the intervals to expect of a film that nobody has taken yet.
Outcome run_plan(const OptionValues& values, const ProgressSink& progress);

}  // namespace palpate
