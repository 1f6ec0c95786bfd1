// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/model/calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "host/io/number_table.hpp"
#include "solver/base/error.hpp"

namespace palpate {

// row = base - length / pixel
TipCalibration read_calibration(const std::filesystem::path& path) {
    const NumberTable table = read_number_table(path);
    const std::vector<double> length = table.values("length_mm"), row = table.values("row_px");
    const double count = double(length.size());
    double mean_length = 0, mean_row = 0;
    for (std::size_t k = 0; k < length.size(); ++k) {
        mean_length += length[k] / count;
        mean_row += row[k] / count;
    }
    double squares = 0, products = 0;
    for (std::size_t k = 0; k < length.size(); ++k) {
        squares += (length[k] - mean_length) * (length[k] - mean_length);
        products += (length[k] - mean_length) * (row[k] - mean_row);
    }
    const auto refuse = [&](const char* why) {
        throw Error(ErrorCode::input_unusable, table.source + ": " + why);
    };
    if (!(squares > 0)) refuse("give tips of two different lengths at least");
    const double slope = products / squares;
    if (!(slope < 0)) refuse("longer tips must reach rows with smaller numbers");
    TipCalibration found;
    found.pixel_z_um.value = -1000 / slope;
    found.base_row_px = mean_row - slope * mean_length;
    if (count > 2) {
        double residuals = 0;
        for (std::size_t k = 0; k < length.size(); ++k) {
            const double away = row[k] - found.base_row_px - slope * length[k];
            residuals += away * away;
        }
        const double sd_slope = std::sqrt(residuals / (count - 2) / squares);
        if (sd_slope > 0) found.pixel_z_um.sd = found.pixel_z_um.value * sd_slope / -slope;
    }
    return found;
}

}  // namespace palpate
