// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/application.hpp"

namespace palpate {

/// `palpate aspirate contours`: frames to profiles.
Outcome run_contours(const OptionValues& values, const ProgressSink& progress);

}  // namespace palpate
