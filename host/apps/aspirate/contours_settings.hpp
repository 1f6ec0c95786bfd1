// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "host/apps/aspirate/contours/outline.hpp"

namespace palpate {

/// What has to be known of the instrument and the camera to read profiles off frames.
struct AspirationInstrument {
    double hole_diameter_mm = 10;
    double rim_thickness_mm = 0.5;  ///< hides so much of the profile
    double pixel_r_um = 0, pixel_z_um = 0;
    double base_row_px = 0;                ///< row of z = 0, the lower face of the rim
    std::optional<double> axis_column_px;  ///< else the outlines' symmetry tells
    bool is_brighter = true;               ///< tissue, than what is behind it
    double rate_hz = 0;                    ///< frames a second
    bool is_published = false;             ///< the published search instead of ours

    /// For frames of this size. Throws Error(input_unusable) if the rim is not in them.
    ContourSettings contours(Index width, Index height) const;
};

/// [instrument] and [frames] of a settings file. Throws Error(invalid_argument),
/// Error(input_unreadable).
AspirationInstrument read_instrument(const std::filesystem::path& path);

}  // namespace palpate
