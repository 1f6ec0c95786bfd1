// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/io/image.hpp"

namespace palpate {

/// Displacement fields are written in whole steps: a thirtieth of the noise of a surface that was
/// seen in voxels of a millimetre. What lies below is noise, too, which does not compress.
constexpr double displacement_step_mm = 1.0 / 128;

/// What the files say about themselves, at most 79 characters.
constexpr const char* displacement_note = "displacement of points, LPS mm, rounded to 1/128 mm";

/// The nearest step, at most 1/256 mm away (exact in single precision up to 131 m); never -0.
inline float in_steps(double mm) {
    constexpr double next_number_is_a_step_away = 1.5 * 0x1p52 * displacement_step_mm;
    return static_cast<float>((mm + next_number_is_a_step_away) - next_number_is_a_step_away);
}

/// Whether writing changes the displacement.
bool is_rounded_by_writing(const Image<Vec3>& image);

/// Throws Error(invalid_argument) unless there is one vector for each voxel, Error(output_failed)
/// if one is not finite.
void check_displacement(const Image<Vec3>& image);

}  // namespace palpate
