// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/aspirate/contours/outline.hpp"
#include "host/apps/aspirate/model/settings_number.hpp"
#include "host/apps/aspirate/model/suction.hpp"

namespace palpate {

/// Coulomb's coefficient of tissue that sticks to the tube: none slips under it.
inline constexpr double stick_friction = 10;
/// Bulk modulus over Young's modulus at the peak of suction, where nothing else is told.
inline constexpr double usual_kappa_over_young = 500;

/// What has to be known of the instrument and the camera to read profiles off frames.
struct AspirationInstrument {
    double hole_diameter_mm = 10;
    double rim_thickness_mm = 0.5;  ///< hides so much of the profile
    double pixel_r_um = 0, pixel_z_um = 0;
    double base_row_px = 0;                ///< row of z = 0, the lower face of the rim
    std::optional<double> axis_column_px;  ///< else the outlines' symmetry tells
    bool is_brighter = true;               ///< tissue, than what is behind it
    double rate_hz = 0;                    ///< frames a second; 0: not told so
    std::vector<double> frame_time_s;      ///< of each frame; may be empty
    bool is_published = false;             ///< the published search instead of ours
    /// Left column, top row, width, height of what is looked at; base row and axis count from
    /// there.
    std::optional<std::array<Index, 4>> crop_px;

    /// From this row on the rim hides the tissue.
    double visible_row() const { return base_row_px - 1000 * rim_thickness_mm / pixel_z_um; }
    /// For frames of this size. Throws Error(input_unusable) if the rim is not in them.
    ContourSettings contours(Index width, Index height) const;
    /// Whether frames are timed here; if not, the film has to say.
    bool has_times() const { return rate_hz > 0 || !frame_time_s.empty(); }
    /// Of a frame, from 0. Throws Error(input_unusable) if no time is given for it.
    double time_s(Index frame) const;
};

/// Tissue that is supposed, to plan an experiment.
struct SupposedTissue {
    double mu_kpa = 1, gamma = 5, amplitude = 0.4, relaxation_s = 3;
    double cap_mm = 1;    ///< height of the surface before suction, over the rim's face
    double sd_mm = 0.01;  ///< noise of a point of a profile
};

/// What the tissue's outer side does: it slides along a wall, is held by one, or nothing touches
/// it.
enum class TissueSide : std::uint8_t { slides, held, free };

/// All that a settings file says.
struct AspirationSettings {
    std::string text;  ///< of the file
    AspirationInstrument instrument;
    SettingNumber hole_diameter_mm, edge_radius_mm, pixel_r_um, pixel_z_um;
    double outer_diameter_mm = 0;
    SettingNumber delay_s;                 ///< of frames behind the readings of suction
    std::optional<Suction> suction;        ///< if it is given there
    SettingNumber depth_mm;                ///< of the tissue
    double width_mm = 0;                   ///< of what is modelled, from the axis
    TissueSide side = TissueSide::slides;  ///< there
    std::vector<std::string> laws;
    std::vector<int> relaxation_terms;  ///< how many are tried
    /// Bulk modulus over Young's modulus that the travel at the peak tells.
    double kappa_over_young = usual_kappa_over_young;
    SettingNumber friction;
    bool sticks = false;  ///< no slip on the tube
    int steps = 32;       ///< that the cycle is solved in
    int refine = 1;       ///< the usual cells are divided in so many a side
    std::optional<SupposedTissue> supposed;
};

/// Which tables of a settings file are needed; others are read where they are there.
enum class AspirationPart : std::uint8_t {
    frames,
    tissue,
    both,
    camera,  ///< frames that nobody times
};

/// `name` stands in messages; files that the text names lie in `folder`. Throws
/// Error(invalid_argument), Error(input_unreadable), and Error(input_unusable) for a table of times
/// that do not ascend.
AspirationSettings parse_aspiration_settings(const std::string& text, const std::string& name,
                                             const std::filesystem::path& folder,
                                             AspirationPart part);
/// The same from a file.
AspirationSettings read_aspiration_settings(const std::filesystem::path& path, AspirationPart part);

}  // namespace palpate
