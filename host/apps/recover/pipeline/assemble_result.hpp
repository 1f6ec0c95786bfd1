// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/pipeline/labelled_state.hpp"
#include "host/apps/recover/pipeline/recovered.hpp"
#include "host/apps/recover/pipeline/target_state.hpp"
#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// Verdicts, surface distances, Dice, volumes.
RecoveryResult assemble_result(const Recovered& found, const LabelledState& reference,
                               const TargetState& target, const Settings& settings);

}  // namespace palpate
