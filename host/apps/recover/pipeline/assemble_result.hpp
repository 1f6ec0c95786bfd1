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

/// The part of it that follows from the mesh, its motion and the images: mesh, displacement, forces
/// and what is held, surfaces and their distances, volumes, and warnings about these. Of `found` it
/// takes the alignment, the recovery model, the target's shapes, displacement, force and the
/// resultants' sd.
void add_motion(const Recovered& found, const LabelledState& reference, const TargetState& target,
                const Settings& settings, RecoveryResult& result);

/// The stiffness of each element, of its region: what the files say of both is equal to the last
/// digit.
void add_element_stiffness(RecoveryResult& result);

}  // namespace palpate
