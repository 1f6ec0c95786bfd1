// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "host/apps/recover/inverse/map_estimate.hpp"
#include "host/apps/recover/modelling/settings.hpp"
#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// Whether any modulus is given: others are found relative to it.
bool has_known_tissue(const Settings& settings);

/// Why a target takes no part in a joint estimate: searches have ended at moduli that the intervals
/// do not hold, or its images contradict what was assumed beforehand. Else empty.
std::string why_told_alone(const MapEstimate& estimate, const Settings& settings);

/// The modulus of unknown `k`, its interval, standard deviation and verdict, with what the model
/// itself adds, into `result`. Not judged where the search gave no interval.
void judge_modulus(const MapEstimate& estimate, std::size_t k, const Settings& settings,
                   RegionResult& result);

}  // namespace palpate
