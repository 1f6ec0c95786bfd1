// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/aspirate/model/aspiration_model.hpp"
#include "host/apps/aspirate/profile_series.hpp"

namespace palpate {

/// The tissue's surface at rest, of profiles before the suction.
struct FoundRest {
    RestSurface surface;
    double left_rms_mm = 0;   ///< what a smooth surface leaves of the points that are seen
    double asymmetry_mm = 0;  ///< rms of half the difference of both sides
    double seen_to_mm = 0;    ///< r up to which it is seen; what is beyond is guessed
    bool is_seen = true;      ///< false: all is behind the rim, and taken as level
};

/// A height that nobody saw, no more than the distance to the end at `end_mm`: a surface that comes
/// down to the rim like a wall would fold the cells below it.
double hidden_height(double r_mm, double z_mm, double end_mm);

/// A polynomial of five even terms through the points without a flag of both sides, by weighted
/// least squares with Tukey's biweight, that ends at the rim (z = 0 where the rounded edge begins):
/// what the rim hides is guessed so.
///   lowest_mm   points below are left out: the line of visibility
FoundRest find_rest(const std::vector<FrameProfile>& frames, double lowest_mm,
                    double hole_radius_mm, double edge_radius_mm);

}  // namespace palpate
