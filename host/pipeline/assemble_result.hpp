// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/pipeline/labelled_state.hpp"
#include "host/pipeline/recovered.hpp"
#include "host/pipeline/target_state.hpp"
#include "host/result/recovery_result.hpp"

namespace palpate {

/// Verdicts, surface distances, Dice, volumes.
RecoveryResult assemble_result(const Recovered& found, const LabelledState& reference,
                               const TargetState& target, const Settings& settings);

}  // namespace palpate
