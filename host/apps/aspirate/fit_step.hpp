// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// `palpate aspirate fit`: profiles and suction to tissue.
Outcome run_fit(const OptionValues& values, const ProgressSink& progress);
/// `palpate aspirate run`: frames and suction to tissue, contours and fit in one.
Outcome run_film(const OptionValues& values, const ProgressSink& progress);

}  // namespace palpate
