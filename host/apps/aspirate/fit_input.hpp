// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/aspirate/profile_series.hpp"
#include "host/apps/aspirate/rest_surface.hpp"

namespace palpate {

/// A point of the profiles that are fitted: the height in the middle of half a millimetre of one
/// frame, or of five points where these are farther apart than 0.1 mm.
struct ThinPoint {
    double time_s = 0;  ///< from the begin of suction, as the frames tell it
    double r_mm = 0, z_mm = 0, sd_mm = 0;
};

/// How far the highest part of the tissue has come over time.
struct ApexTravel {
    std::vector<double> time_s, travel_mm, suction_kpa;
};

/// Where a search begins, on the stiff side.
struct TissueStart {
    double mu_kpa = 1, gamma = 5, amplitude = 0.4, relaxation_s = 3;
    double peak_stiffness_kpa = 10;  ///< Young's modulus that the travel at the peak tells
};

/// What is fitted, from profiles and suction.
struct AspirationFitInput {
    FoundRest rest;
    SuctionSteps steps;
    double begin_s = 0;  ///< of suction, in the time of the readings
    std::vector<ThinPoint> points;
    ApexTravel apex;  ///< of all frames
    TissueStart start;
    Index num_frames = 0, num_used_frames = 0;
    double asymmetry_mm = 0, flagged_percent = 0;
    double axis_mm = 0;           ///< r of the profiles from which `points` count theirs
    double seen_later_to_mm = 0;  ///< the farthest r that is seen in some frames
    std::vector<std::string> warnings;

    std::string points_csv() const;
};

/// Chooses frames near the times at which the body will be solved, and takes heights. Throws
/// Error(input_unusable) where suction and film do not overlap, no frame is from before the
/// suction, nothing moves or is seen, points are more than 0.2 mm apart, or sides differ by more
/// than 0.3 mm.
AspirationFitInput make_fit_input(const ProfileSeries& profiles, const Suction& suction,
                                  const AspirationSettings& settings);

}  // namespace palpate
