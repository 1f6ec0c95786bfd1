// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/apps/aspirate/model/suction.hpp"
#include "host/apps/phantom/aspiration/film_look.hpp"

namespace palpate {

/// Everything about a film of sucked tissue that whoever looks at the film wants to know, or does
/// not know exactly.
struct AspirationTruth {
    unsigned seed = 1;
    bool is_perfect = false;
    // the tissue: veronda-westmann with one relaxation term
    double mu_kpa = 0.7, gamma = 10, amplitude = 0.4, time_s = 3;
    double cap_mm = 1;  ///< height of the surface at rest over the rim's face
    // the instrument as it is
    double edge_radius_mm = 0.2, pixel_r_um = 62.9, pixel_z_um = 31.75;
    double delay_s = 0;  ///< of the frames behind the readings of suction
    double axis_column_px = 89.5;
    double tilt = 0;  ///< of the camera, radians
    // what is done
    Suction suction;
    double film_s = 14;
    // how it looks
    FilmScene scene;
    double jitter_s = 0;      ///< sd of when a frame is taken
    double dropped_part = 0;  ///< of the frames
};

/// What the settings of the phantom say.
struct AspirationNominal {
    static constexpr double hole_diameter_mm = 10, outer_diameter_mm = 20, rim_thickness_mm = 0.5,
                            depth_mm = 20, width_mm = 20;
    static constexpr double edge_radius_mm = 0.2, edge_radius_sd_mm = 0.05;
    static constexpr double pixel_r_um = 62.9, pixel_z_um = 31.75, pixel_sd_part = 0.005;
    static constexpr double delay_sd_s = 0.02, rate_hz = 25, base_row_px = 150;
    static constexpr Index width_px = 180, height_px = 180;
};

/// Drawn evenly in the logarithm: mu 0.2 to 5 kPa, gamma 1 to 25, C 0.1 to 1, tau 0.5 to 8 s; what
/// the instrument's settings say with an sd from that; suction such that the tissue comes up by 0.9
/// to 1.6 mm, about. If `is_perfect` the instrument is as it is told and nothing mars the film.
AspirationTruth draw_aspiration(unsigned seed, bool is_perfect);

}  // namespace palpate
