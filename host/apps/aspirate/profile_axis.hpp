// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/aspirate/profile_series.hpp"

namespace palpate {

/// An axis that was found in a few frames is believed within this much.
inline constexpr double found_axis_sd_mm = 0.1;

/// The r about which the profiles of a whole film are most alike on both sides, mm: with z(r, t) at
/// points without a flag, the c of least
///     mean over t, d of min((z(c + d, t) - z(c - d, t))^2, (0.1 mm)^2),
/// at most 1 mm from r = 0, where at least half as many pairs are seen as elsewhere. 0 if there are
/// hardly any, or sides are alike nowhere.
double axis_of(const ProfileSeries& profiles);

/// Counts r from `axis_mm` on.
void move_axis(double axis_mm, ProfileSeries& profiles);

}  // namespace palpate
