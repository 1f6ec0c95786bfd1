// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/aspirate/contours/outline.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// A few columns that agree with the outline amid many that do not are where a wrong path crosses
/// it, as at the rim of a bubble: they become guessed, too, with their neighbours' errors.
void flag_islands(Outline& outline);

/// What pixels show beyond the background, of columns side by side.
struct BeyondBackground {
    const std::vector<float>& grey;    ///< [width][stride]
    Index stride, rows;                ///< rows that are seen
    float sigma;                       ///< of grey, where there is background alone
    const std::vector<float>& tissue;  ///< [width] the tissue's grey beyond the background
};

/// A run of columns that agree with the outline floats where most of them have background below
/// it, and beside it at least as many are doubted: it is of a bubble above the tissue. They become
/// guessed, too, and count for others beside them.
void flag_floating(const BeyondBackground& beyond, Outline& outline);

/// Sucked tissue bulges. Where a straight line from column to column, a third of the frame at most
/// and some rows above the line of visibility at both ends, passes 2.5 rows or more over the points
/// without a flag between, something as dark as the background (blood) has taken a bite out of the
/// outline: those more than a row below the line become guessed, with that for an sd.
///   visible_rows   of the line of visibility
void flag_bites(double visible_rows, Outline& outline);

}  // namespace palpate
