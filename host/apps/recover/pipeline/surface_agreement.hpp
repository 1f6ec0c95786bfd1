// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/pipeline/recovered.hpp"
#include "host/apps/recover/pipeline/target_state.hpp"
#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// How far the surface `s` of the reference lies from its target before and after it moved: fills
/// the distances of vertices, which of them the target shows, and the summaries over those: mean,
/// largest, and the 95 % Hausdorff distance, the larger of the 95th percentiles by area from the
/// surface to the target and back (Huttenlocher et al., IEEE PAMI 1993; the way back only where
/// `result.target` is a surface, and not from what lies beyond the rim of an open one).
void measure_agreement(const Recovered& found, std::size_t s, const TargetState& target,
                       SurfaceResult& result);

}  // namespace palpate
