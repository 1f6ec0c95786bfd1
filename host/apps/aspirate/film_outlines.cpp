// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/film_outlines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <optional>

#include "host/apps/aspirate/frames/frame_source.hpp"
#include "host/apps/aspirate/outline_finder.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double least_contrast = 8;  // sum of four rows: two greys
constexpr double most_lost_part = 0.2, most_asymmetry_mm = 0.3;

/// Adds, over sure points, the grey 3 to 6 rows below less that as far above; not of the rim.
void add_contrast(const GreyFrame& frame, const Outline& outline, double visible_row,
                  FilmOutlines& film) {
    constexpr Index nearest = 3, farthest = 6;
    for (Index x = 0; x < Index(outline.size()); ++x) {
        const OutlinePoint& point = outline[std::size_t(x)];
        const auto row = Index(std::lround(point.row));
        if (point.flag != PointFlag::ok || row < farthest ||
            double(row + farthest) >= std::min(visible_row, double(frame.height)))
            continue;
        ++film.num_compared;
        for (Index k = nearest; k <= farthest; ++k)
            film.contrast += double(frame.grey[std::size_t((row + k) * frame.width + x)] -
                                    frame.grey[std::size_t((row - k) * frame.width + x)]);
    }
}

void add_frame(FilmOutlines& film, const GreyFrame& frame, const Outline& outline, double time_s,
               const AspirationInstrument& instrument) {
    Index seen = 0, sure = 0;
    double highest = std::numeric_limits<double>::max();
    for (const OutlinePoint& point : outline) {
        if (point.flag == PointFlag::hidden) continue;
        ++seen;
        if (point.flag != PointFlag::ok) continue;
        ++sure;
        highest = std::min(highest, point.row);
    }
    add_contrast(frame, outline, instrument.visible_row(), film);
    film.num_points += seen;
    film.num_guessed += seen - sure;
    if (2 * sure <= seen) {
        ++film.num_lost;
    } else {
        film.time_s.push_back(time_s);
        film.apex_mm.push_back((instrument.base_row_px - highest) * instrument.pixel_z_um / 1000);
    }
    film.strip.add(frame, outline, time_s);
    ++film.num_frames;
}

/// A film that lost frames would be taken for another one.
void check_number_of_times(const AspirationInstrument& instrument, Index num_frames) {
    const auto num_times = Index(instrument.frame_time_s.size());
    if (num_times > 0 && num_times != num_frames)
        throw Error(ErrorCode::input_unusable,
                    fmt::format("[frames] times has {} times for {} frames; give a time for each "
                                "frame, and all frames",
                                num_times, num_frames));
}

void refuse_bad_film(const FilmOutlines& film, const AspirationInstrument& instrument) {
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::input_unusable, why); };
    if (film.num_frames == 0) refuse("there is no frame; give at least one");
    if (film.num_lost == film.num_frames)
        refuse(
            "no tissue is seen above the line of visibility in any frame; correct base_row_px, "
            "tissue or the film");
    if (film.num_lost > most_lost_part * film.num_frames)
        refuse(fmt::format(
            "the outline is lost in {} of {} frames, above row {:.0f}, the line of "
            "visibility; correct base_row_px ({:g}), rim_thickness_mm or pixel_z_um if "
            "the rim is not there, or take better light and contrast",
            film.num_lost, film.num_frames, instrument.visible_row(), instrument.base_row_px));
    const double contrast = (instrument.is_brighter ? 1 : -1) * film.contrast;
    if (contrast < -least_contrast * film.num_compared)
        refuse(
            fmt::format("what lies below the outline is {0} than what is above, but tissue is told "
                        "to be {1}; set tissue = \"{0}\", or turn the film upright",
                        instrument.is_brighter ? "darker" : "brighter",
                        instrument.is_brighter ? "brighter" : "darker"));
    if (film.axis.asymmetry_mm > most_asymmetry_mm)
        refuse(
            fmt::format("the tissue's sides differ by {:.2f} mm about the axis; allowed: {:g}; "
                        "put the tube on straight, or correct axis_column_px",
                        film.axis.asymmetry_mm, most_asymmetry_mm));
}

FrameSource source_of(const OptionValues& values, const ProgressSink& progress) {
    const bool is_raw = values.text("frames") == "-";
    if (is_raw != values.is_given("raw"))
        throw Error(ErrorCode::invalid_argument,
                    is_raw ? "raw bytes need their size; give --raw WIDTHxHEIGHT"
                           : "--raw is for bytes on standard input; give - in place of a folder");
    return is_raw ? FrameSource(std::cin, values.text("raw"))
                  : FrameSource(values.path("frames"), progress);
}

/// What the settings say goes before what the film says.
class FrameTimes {
public:
    FrameTimes(const AspirationInstrument& instrument, const FrameSource& source)
        : instrument_(instrument), source_(source) {}

    double next() {
        const Index number = number_++;
        if (instrument_.has_times()) return instrument_.time_s(number);
        const auto told = source_.time_s();
        if (!told)
            throw Error(ErrorCode::invalid_argument,
                        "nothing tells when frames were taken; give rate_hz or times in [frames]");
        if (number > 0 && !(*told > last_s_))
            throw Error(ErrorCode::input_unusable,
                        fmt::format("the film's times go back at frame {}, to {:g} s after {:g} "
                                    "s; give rate_hz or times in [frames]",
                                    number + 1, *told, last_s_));
        return last_s_ = *told;
    }

private:
    const AspirationInstrument& instrument_;
    const FrameSource& source_;
    Index number_ = 0;
    double last_s_ = 0;
};

}  // namespace

FilmOutlines follow_film(const OptionValues& values, const AspirationInstrument& instrument,
                         const std::function<void(const std::string&)>& write,
                         const ProgressSink& progress) {
    FrameSource source = source_of(values, progress);
    if (source.num_frames() > 0) check_number_of_times(instrument, source.num_frames());
    FrameTimes times(instrument, source);
    OutlineFinder finder(instrument);
    ProfileWriter writer(instrument, write);
    FilmOutlines film;
    GreyFrame frame;
    while (source.next(frame)) {
        const Outline& outline = finder.add(frame);
        const double time_s = times.next();
        add_frame(film, finder.seen(), outline, time_s, instrument);
        writer.add(outline, time_s);
        const double done =
            source.num_frames() ? double(film.num_frames) / double(source.num_frames()) : -1;
        if (film.num_frames % 50 == 1)
            report_progress(progress, "frames", done, fmt::format("{} outlines", film.num_frames));
        check_cancelled(progress);
    }
    writer.finish();
    check_number_of_times(instrument, film.num_frames);
    film.axis = writer.axis();
    refuse_bad_film(film, instrument);
    return film;
}

FilmOutlines write_profiles(const std::filesystem::path& folder, const OptionValues& values,
                            const AspirationInstrument& instrument, const ProgressSink& progress) {
    std::ofstream profiles(folder / profiles_file, std::ios::binary);
    FilmOutlines film = follow_film(
        values, instrument, [&](const std::string& rows) { profiles << rows; }, progress);
    if (!profiles.flush())
        throw Error(ErrorCode::output_failed,
                    fmt::format("cannot write '{}': is the disk full?", folder.string()));
    return film;
}

double axis_column_px(const FilmOutlines& film, const AspirationInstrument& instrument) {
    return film.axis.column + (instrument.crop_px ? double((*instrument.crop_px)[0]) : 0);
}

FilmLines film_lines(const FilmOutlines& film, const AspirationInstrument& instrument) {
    return {.base_row = instrument.base_row_px,
            .visible_row = instrument.visible_row(),
            .axis_column = film.axis.column,
            .rows_per_column = instrument.pixel_z_um / instrument.pixel_r_um};
}

ResultTree outlines_tree(const FilmOutlines& film, const AspirationInstrument& instrument) {
    ResultTree tree =
        ResultTree::of("contours", {{"format", "palpate-contours"}, {"format_version", 1}});
    tree.title = "Outlines of tissue";
    tree.add({.name = "frames", .value = std::int64_t(film.num_frames), .title = "Frames"});
    tree.add({.name = "lost_frames",
              .value = std::int64_t(film.num_lost),
              .title = "Frames without an outline"});
    tree.add({.name = "guessed_percent",
              .value = 100 * film.num_guessed / std::max(1.0, film.num_points),
              .unit = "%",
              .title = "Points that are flagged",
              .decimals = 1});
    tree.add({.name = "axis_column_px",
              .value = axis_column_px(film, instrument),
              .unit = "px",
              .title = film.axis.is_known ? "Column of the axis"
                                          : "Column of the axis (the middle: no frame shows both "
                                            "sides)",
              .decimals = 2});
    tree.add({.name = "asymmetry_mm",
              .value = film.axis.asymmetry_mm,
              .unit = "mm",
              .title = "Asymmetry of the outlines",
              .decimals = 3});
    const auto [low, high] = std::minmax_element(film.apex_mm.begin(), film.apex_mm.end());
    tree.add({.name = "travel_mm",
              .value = *high - *low,
              .unit = "mm",
              .title = "Travel of the highest point",
              .decimals = 3});
    return tree;
}

}  // namespace palpate
