// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "host/apps/aspirate/model/settings_number.hpp"

namespace palpate {

/// Rows of a camera as heights: z = pixel_z (base_row - row).
struct TipCalibration {
    SettingNumber pixel_z_um;  ///< with its sd where more than two tips were measured
    double base_row_px = 0;    ///< of z = 0
};

/// From tips of known lengths above the lower face of the rim, columns length_mm and row_px: the
/// straight line of least squares. Throws Error(input_unreadable) for what is no such table,
/// Error(input_unusable) for fewer than two lengths and for rows that do not go up with length.
TipCalibration read_calibration(const std::filesystem::path& path);

}  // namespace palpate
