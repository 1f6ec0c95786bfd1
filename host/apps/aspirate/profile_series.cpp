// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/profile_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/io/number_table.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_rows = 2000000;

PointFlag flag_of(double number, const NumberTable& table, std::size_t row) {
    if (number != 0 && number != 1 && number != 2 && number != 3)
        table.refuse_row(row, "a flag is 0 (ok), 1 (guessed), 2 (hidden) or 3 (lost)");
    return PointFlag(int(number));
}

}  // namespace

ProfileSeries read_profiles(const std::filesystem::path& path) {
    const NumberTable table = read_number_table(path, most_rows);
    const auto time_s = table.values("time_s"), r_mm = table.values("r_mm"),
               z_mm = table.values("z_mm"), sd_mm = table.values("sd_mm");
    const auto flags =
        table.find("flag") ? table.values("flag") : std::vector<double>(time_s.size(), 0.0);
    const auto refuse = [&](std::size_t row, const std::string& why) {
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{}, line {}: {}", table.source, table.lines[row], why));
    };
    ProfileSeries series;
    for (std::size_t row = 0; row < time_s.size(); ++row) {
        if (series.empty() || time_s[row] != series.back().time_s) {
            if (!series.empty() && time_s[row] < series.back().time_s)
                refuse(row, fmt::format("times must not go back; there is {:g} s after {:g} s",
                                        time_s[row], series.back().time_s));
            series.push_back({time_s[row], {}});
        }
        if (!(sd_mm[row] > 0)) refuse(row, "an sd must be greater than 0");
        series.back().points.push_back(
            {r_mm[row], z_mm[row], sd_mm[row], flag_of(flags[row], table, row)});
    }
    for (FrameProfile& frame : series)
        std::sort(frame.points.begin(), frame.points.end(),
                  [](const ProfilePoint& a, const ProfilePoint& b) { return a.r_mm < b.r_mm; });
    return series;
}

ProfilePoint profile_point(const OutlinePoint& point, double column, double axis_column,
                           const AspirationInstrument& instrument) {
    const double rim = instrument.rim_thickness_mm, mm = instrument.pixel_z_um / 1000;
    const bool is_hidden = point.flag == PointFlag::hidden;
    return {.r_mm = (column - axis_column) * instrument.pixel_r_um / 1000,
            .z_mm = is_hidden ? rim / 2 : (instrument.base_row_px - point.row) * mm,
            .sd_mm = is_hidden ? rim / std::sqrt(12.0) : point.sd * mm,
            .flag = point.flag};
}

FrameProfile whole_profile_of(const Outline& outline, double time_s, double axis_column,
                              const AspirationInstrument& instrument) {
    FrameProfile profile{time_s, {}};
    profile.points.reserve(outline.size());
    for (std::size_t x = 0; x < outline.size(); ++x)
        profile.points.push_back(profile_point(outline[x], double(x), axis_column, instrument));
    return profile;
}

FrameProfile profile_of(const Outline& outline, double time_s, double axis_column,
                        const AspirationInstrument& instrument) {
    const double radius_mm = 0.5 * instrument.hole_diameter_mm;
    FrameProfile profile = whole_profile_of(outline, time_s, axis_column, instrument);
    std::erase_if(profile.points,
                  [&](const ProfilePoint& point) { return std::abs(point.r_mm) > radius_mm; });
    return profile;
}

}  // namespace palpate
