// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// A made-up but consistent recovery: two touching prostate zones (unknown), a bladder that pushes
/// on them and a rectum (driven), a bone (fixed), in a tilted grid of 2 x 2 x 3 mm voxels. The
/// displacement is a smooth formula; the surfaces after it miss the target by less than 0.3 mm.
RecoveryResult synthetic_result();

}  // namespace palpate
