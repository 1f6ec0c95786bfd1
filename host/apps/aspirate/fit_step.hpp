// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// `palpate aspirate fit`: profiles and suction to tissue.
Outcome run_fit(const OptionValues& values, const ProgressSink& progress);

}  // namespace palpate
