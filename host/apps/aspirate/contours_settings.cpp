// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours_settings.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "host/io/files.hpp"
#include "host/io/settings_table.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

double needed(const SettingsTable& table, const char* key, NumberRange range, const char* example) {
    const auto value = table.number(key, range);
    if (!value) table.missing(key, example);
    return *value;
}

}  // namespace

ContourSettings AspirationInstrument::contours(Index width, Index height) const {
    const double visible = base_row_px - 1000 * rim_thickness_mm / pixel_z_um;
    if (base_row_px >= double(height) || visible < 24)
        throw Error(
            ErrorCode::input_unusable,
            fmt::format("nothing can be seen above the line of visibility: base_row_px is {:g} "
                        "and the rim hides rows from {:.0f} on, in frames of {} rows; correct "
                        "base_row_px, rim_thickness_mm or pixel_z_um",
                        base_row_px, visible, height));
    return {width, height, visible, is_brighter};
}

AspirationInstrument read_instrument(const std::filesystem::path& path) {
    if (const auto why = why_unreadable(path))
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("cannot read '{}': {}; check the path", path.string(), *why));
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const SettingsTable all = SettingsTable::parse(text, path.filename().string());
    all.allow_keys({"instrument", "frames"});
    const auto instrument = all.table("instrument"), frames = all.table("frames");
    if (!instrument) all.missing("instrument", "a table [instrument]");
    if (!frames) all.missing("frames", "a table [frames] with rate_hz");
    instrument->allow_keys({"hole_diameter_mm", "rim_thickness_mm", "pixel_r_um", "pixel_z_um",
                            "base_row_px", "axis_column_px", "tissue"});
    frames->allow_keys({"rate_hz", "method"});
    const NumberRange length_mm{0, 200, true}, pixel_um{0, 10000, true}, pixels{0, 20000};
    AspirationInstrument read;
    read.hole_diameter_mm = needed(*instrument, "hole_diameter_mm", length_mm, "10.0, for example");
    read.rim_thickness_mm = needed(*instrument, "rim_thickness_mm", {0, 50}, "0.5, for example");
    read.pixel_r_um = needed(*instrument, "pixel_r_um", pixel_um, "62.9, for example");
    read.pixel_z_um = needed(*instrument, "pixel_z_um", pixel_um, "31.75, for example");
    read.base_row_px = needed(*instrument, "base_row_px", pixels, "150, for example");
    read.axis_column_px = instrument->number("axis_column_px", pixels);
    if (const auto tissue = instrument->choice("tissue", {"brighter", "darker"}))
        read.is_brighter = *tissue == "brighter";
    read.rate_hz = needed(*frames, "rate_hz", {0, 1e6, true}, "25.0, for example");
    if (const auto method = frames->choice("method", {"path", "published"}))
        read.is_published = *method == "published";
    return read;
}

}  // namespace palpate
