// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/aspirate/contours/outline.hpp"

namespace palpate {

/// A few columns that agree with the outline amid many that do not are where a wrong path crosses
/// it, as at the rim of a bubble: they become guessed, too, with their neighbours' errors.
void flag_islands(Outline& outline);

}  // namespace palpate
