// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/aspirate/profile_series.hpp"

namespace palpate {

/// An axis that was found in a few frames is believed within this much.
inline constexpr double found_axis_sd_mm = 0.1;

/// From so many frames with tissue the axis is found where it is not told.
inline constexpr std::size_t frames_for_axis = 10;
inline constexpr Index least_axis_pairs = 5;  ///< of points that are compared

/// How alike profiles are on both sides.
struct ProfileAxis {
    double r_mm = 0;          ///< of the axis
    double asymmetry_mm = 0;  ///< root mean square of half of the differences of both sides
    Index num_pairs = 0;      ///< points without a flag on both sides that were compared
};

ProfileAxis axis_at(const ProfileSeries& profiles, double r_mm, double hole_radius_mm);

/// The r about which a few profiles are most alike, to 0.001 radii of the hole: the least median of
/// |z(r + d) - z(r - d)|, so that a bubble on one side does not draw it. No farther from 0 than
/// 0.45 radii, or two fifths of half a profile's width if that is more; 0 where nothing tells it
/// (`num_pairs` is less than `least_axis_pairs` then).
ProfileAxis find_axis(const ProfileSeries& profiles, double hole_radius_mm);

/// The r about which the profiles of a whole film are most alike on both sides, mm. With z(r, t) at
/// points without a flag it is the c of least
///     median over t, d of |z(c + d, t) - z(c - d, t) - 2 s d|,
/// s the slope of a camera that is turned, by 0.03 at most; as the tissue rises, c and s part. 0
/// where that tells nothing: with few pairs as far out as half of `hole_radius_mm`, a c that is
/// 1.5 mm from r = 0 or farther, a median that is more than half of that about r = 0, or more than
/// four fifths of that with any slope, as of a tube that is put on askew, or sides that differ by
/// less than 0.02 mm about r = 0.
double axis_of(const ProfileSeries& profiles, double hole_radius_mm);

/// Counts r from `axis_mm` on.
void move_axis(double axis_mm, ProfileSeries& profiles);

}  // namespace palpate
