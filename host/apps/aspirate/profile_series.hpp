// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/apps/aspirate/contours/outline.hpp"
#include "host/apps/aspirate/model/aspiration_settings.hpp"

namespace palpate {

/// A point of a profile; r is negative left of the axis, z counts from the rim's lower face.
struct ProfilePoint {
    double r_mm = 0, z_mm = 0, sd_mm = 0;
    PointFlag flag = PointFlag::ok;
};

/// The profile in one frame, points from left to right.
struct FrameProfile {
    double time_s = 0;
    std::vector<ProfilePoint> points;
};

using ProfileSeries = std::vector<FrameProfile>;

/// Columns time_s, r_mm, z_mm, sd_mm and, where points may be bad, flag (0 ok, 1 guessed, 2 hidden,
/// 3 lost). Throws Error(input_unreadable) for what is no such table, Error(input_unusable) for
/// times that go back and an sd that is not above 0.
ProfileSeries read_profiles(const std::filesystem::path& path);

/// The point of column x,
///     r = (x - axis) pixel_r,   z = (y_base - y) pixel_z.
/// A hidden point is in the middle of what the rim hides.
ProfilePoint profile_point(const OutlinePoint& point, double column, double axis_column,
                           const AspirationInstrument& instrument);

/// An outline as a profile, of all columns.
FrameProfile whole_profile_of(const Outline& outline, double time_s, double axis_column,
                              const AspirationInstrument& instrument);
/// The same of what lies within the hole.
FrameProfile profile_of(const Outline& outline, double time_s, double axis_column,
                        const AspirationInstrument& instrument);

}  // namespace palpate
