// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/apps/aspirate/axis_finder.hpp"
#include "host/apps/aspirate/outline_finder.hpp"
#include "host/apps/aspirate/profile_series.hpp"
#include "host/faces/capi/guard.hpp"
#include "host/faces/capi/handles.hpp"
#include "host/io/decode_pictures.hpp"

using namespace palpate;
using capi::guarded;
using capi::require;

/// The handle.
struct palpate_tracker {
    explicit palpate_tracker(const AspirationInstrument& told)
        : instrument(told), finder(told), axis(told) {}

    Index num_columns() const {
        return instrument.crop_px ? (*instrument.crop_px)[2] : frame.width;
    }

    AspirationInstrument instrument;
    OutlineFinder finder;
    GreyFrame frame;
    AxisFinder axis;
};

namespace {

constexpr int brightest_byte = 255, brightest_word = 65535;

void take_grey(const void* grey, int white, GreyFrame& frame) {
    const float scale = float(brightest_byte) / float(white);
    const auto take = [&](const auto* pixels) {
        for (std::size_t n = 0; n < frame.grey.size(); ++n)
            frame.grey[n] = std::min(scale * float(pixels[n]), float(brightest_byte));
    };
    if (white <= brightest_byte)
        take(static_cast<const std::uint8_t*>(grey));
    else
        take(static_cast<const std::uint16_t*>(grey));
}

}  // namespace

palpate_status palpate_tracker_create(const char* settings_toml, const char* folder,
                                      std::int32_t width, std::int32_t height,
                                      palpate_tracker** tracker) {
    return guarded([&] {
        require(tracker, "the place for the tracker");
        *tracker = nullptr;
        require(settings_toml, "the text of the settings");
        if (width < 1 || height < 1 || width > most_pixels_a_side || height > most_pixels_a_side)
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("frames have {} x {} pixels; allowed: 1 to {} a side", width,
                                    height, most_pixels_a_side));
        const auto settings = parse_aspiration_settings(
            settings_toml, "settings", folder ? folder : "", AspirationPart::camera);
        auto made = std::make_unique<palpate_tracker>(settings.instrument);
        made->frame = {width, height, std::vector<float>(std::size_t(width) * std::size_t(height))};
        made->finder.begin(width, height);
        *tracker = capi::Handles<palpate_tracker>::all().keep(std::move(made));
        return PALPATE_OK;
    });
}

palpate_status palpate_tracker_free(palpate_tracker* tracker) {
    return guarded([&] {
        capi::release(tracker, "the tracker");
        return PALPATE_OK;
    });
}

std::int32_t palpate_tracker_num_columns(const palpate_tracker* tracker) {
    const auto body = capi::found(tracker);
    return body ? std::int32_t(body->num_columns()) : 0;
}

palpate_status palpate_tracker_add(palpate_tracker* tracker, const void* grey, std::int32_t white,
                                   double* z_mm, double* sd_mm, std::uint8_t* flag) {
    return guarded([&] {
        const auto held = capi::hold(tracker, "the tracker");
        require(grey, "the frame");
        if (white < 1 || white > brightest_word)
            throw Error(
                ErrorCode::invalid_argument,
                fmt::format("the grey of white is {}; allowed: 1 to {}", white, brightest_word));
        take_grey(grey, white, tracker->frame);
        const Outline& outline = tracker->finder.add(tracker->frame);
        tracker->axis.add(outline);
        for (std::size_t x = 0; x < outline.size(); ++x) {
            const ProfilePoint point = profile_point(outline[x], double(x), 0, tracker->instrument);
            if (z_mm) z_mm[x] = point.z_mm;
            if (sd_mm) sd_mm[x] = point.sd_mm;
            if (flag) flag[x] = std::uint8_t(point.flag);
        }
        return PALPATE_OK;
    });
}

palpate_status palpate_tracker_axis(const palpate_tracker* tracker, double* axis_column_px,
                                    double* r_mm, double* hole_radius_mm) {
    return guarded([&] {
        const auto held = capi::hold(tracker, "the tracker");
        if (!tracker->axis.is_known())
            throw Error(ErrorCode::input_unusable,
                        "no frame with tissue has told where the axis is; add one, or give "
                        "axis_column_px");
        const double axis = tracker->axis.column();
        if (axis_column_px)
            *axis_column_px =
                axis +
                (tracker->instrument.crop_px ? double((*tracker->instrument.crop_px)[0]) : 0);
        for (Index x = 0; r_mm && x < tracker->num_columns(); ++x)
            r_mm[x] = profile_point({}, double(x), axis, tracker->instrument).r_mm;
        if (hole_radius_mm) *hole_radius_mm = 0.5 * tracker->instrument.hole_diameter_mm;
        return PALPATE_OK;
    });
}
