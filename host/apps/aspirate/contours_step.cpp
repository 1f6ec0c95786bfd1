// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <optional>

#include "host/apps/aspirate/contours/contour_tracker.hpp"
#include "host/apps/aspirate/contours/published_outline.hpp"
#include "host/apps/aspirate/contours_page.hpp"
#include "host/apps/aspirate/frame_source.hpp"
#include "host/apps/aspirate/profile_writer.hpp"
#include "host/io/output_folder.hpp"
#include "host/page/tree_html.hpp"
#include "host/page/tree_json.hpp"
#include "host/page/tree_text.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double most_lost_part = 0.2, most_asymmetry_mm = 0.3;
constexpr const char* profiles_file = "profiles.csv";

GreyFrame cropped(const GreyFrame& frame, const std::array<Index, 4>& crop) {
    const auto [left, top, width, height] = crop;
    if (left + width > frame.width || top + height > frame.height)
        throw Error(ErrorCode::input_unusable,
                    fmt::format("crop_px reaches to column {} and row {}, but frames have {} x {} "
                                "pixels; correct it",
                                left + width, top + height, frame.width, frame.height));
    GreyFrame part{width, height, {}};
    part.grey.reserve(std::size_t(width * height));
    for (Index y = top; y < top + height; ++y) {
        const auto row = frame.grey.begin() + y * frame.width + left;
        part.grey.insert(part.grey.end(), row, row + width);
    }
    return part;
}

/// Either way of finding outlines.
class Finder {
public:
    explicit Finder(const AspirationInstrument& instrument) : instrument_(instrument) {}
    const Outline& add(const GreyFrame& frame) {
        if (!ours_ && !published_) {
            const ContourSettings settings = instrument_.contours(frame.width, frame.height);
            if (instrument_.is_published)
                published_.emplace(settings);
            else
                ours_.emplace(settings);
        }
        return ours_ ? ours_->add(frame) : published_->add(frame);
    }

private:
    AspirationInstrument instrument_;
    std::optional<ContourTracker> ours_;
    std::optional<PublishedOutline> published_;
};

struct FilmCounts {
    Index frames = 0, lost_frames = 0;
    double points = 0, guessed = 0;
    std::vector<double> seconds = {}, apex_mm = {};
    FilmStrip strip = {};

    void add(const GreyFrame& frame, const Outline& outline,
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
        points += seen;
        guessed += seen - sure;
        if (2 * sure <= seen) {
            ++lost_frames;
        } else {
            seconds.push_back(instrument.time_s(frames));
            apex_mm.push_back((instrument.base_row_px - highest) * instrument.pixel_z_um / 1000);
        }
        strip.add(frame, outline);
        ++frames;
    }
};

void refuse_bad_film(const FilmCounts& film, const OutlineAxis& axis,
                     const AspirationInstrument& instrument) {
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::input_unusable, why); };
    if (film.frames == 0) refuse("there is no frame; give at least one");
    if (film.lost_frames == film.frames)
        refuse(
            "no tissue is seen above the line of visibility in any frame; correct base_row_px, "
            "tissue or the film");
    if (film.lost_frames > most_lost_part * film.frames)
        refuse(
            fmt::format("the outline is lost in {} of {} frames; better light or contrast is "
                        "needed",
                        film.lost_frames, film.frames));
    const double asymmetry_mm = axis.asymmetry * instrument.pixel_z_um / 1000;
    if (asymmetry_mm > most_asymmetry_mm)
        refuse(
            fmt::format("the tissue's sides differ by {:.2f} mm about the axis; allowed: {:g}; "
                        "put the tube on straight, or correct axis_column_px",
                        asymmetry_mm, most_asymmetry_mm));
}

/// From the first frame to the last.
OutlineAxis follow_film(const OptionValues& values, const AspirationInstrument& instrument,
                        const std::function<void(const std::string&)>& write, FilmCounts& film,
                        const ProgressSink& progress) {
    const bool is_raw = values.text("frames") == "-";
    if (is_raw != values.is_given("raw"))
        throw Error(ErrorCode::invalid_argument,
                    is_raw ? "raw bytes need their size; give --raw WIDTHxHEIGHT"
                           : "--raw is for bytes on standard input; give - in place of a folder");
    FrameSource source =
        is_raw ? FrameSource(std::cin, values.text("raw")) : FrameSource(values.path("frames"));
    Finder finder(instrument);
    ProfileWriter writer(instrument, write);
    GreyFrame frame;
    while (source.next(frame)) {
        if (instrument.crop_px) frame = cropped(frame, *instrument.crop_px);
        const Outline& outline = finder.add(frame);
        film.add(frame, outline, instrument);
        writer.add(outline);
        const double done = source.num_frames() ? double(film.frames) / source.num_frames() : 0;
        if (film.frames % 50 == 1) report_progress(progress, "frames", done, "outlines");
        check_cancelled(progress);
    }
    writer.finish();
    refuse_bad_film(film, *writer.axis(), instrument);
    return *writer.axis();
}

ResultTree tree_of(const FilmCounts& film, const OutlineAxis& axis,
                   const AspirationInstrument& instrument) {
    ResultTree tree =
        ResultTree::of("contours", {{"format", "palpate-contours"}, {"format_version", 1}});
    tree.title = "Outlines of tissue";
    tree.add({.name = "frames", .value = std::int64_t(film.frames), .title = "Frames"});
    tree.add({.name = "lost_frames",
              .value = std::int64_t(film.lost_frames),
              .title = "Frames without an outline"});
    tree.add({.name = "guessed_percent",
              .value = 100 * film.guessed / std::max(1.0, film.points),
              .unit = "%",
              .title = "Points that are flagged",
              .decimals = 1});
    tree.add({.name = "axis_column_px",
              .value = axis.column,
              .unit = "px",
              .title = "Column of the axis",
              .decimals = 2});
    tree.add({.name = "asymmetry_mm",
              .value = axis.asymmetry * instrument.pixel_z_um / 1000,
              .unit = "mm",
              .title = "Asymmetry",
              .decimals = 3});
    const auto [low, high] = std::minmax_element(film.apex_mm.begin(), film.apex_mm.end());
    tree.add({.name = "travel_mm",
              .value = *high - *low,
              .unit = "mm",
              .title = "Travel of the highest point",
              .decimals = 3});
    return tree;
}

}  // namespace

Outcome run_contours(const OptionValues& values, const ProgressSink& progress) {
    const AspirationInstrument instrument =
        read_aspiration_settings(values.path("config"), AspirationPart::frames).instrument;
    FilmCounts film;
    if (!values.is_given("out")) {
        const OutlineAxis axis = follow_film(
            values, instrument,
            [](const std::string& rows) {
                std::fwrite(rows.data(), 1, rows.size(), stdout);
                if (std::fflush(stdout) != 0)
                    throw Error(ErrorCode::output_failed, "cannot write to standard output");
            },
            film, progress);
        return {
            .result = tree_of(film, axis, instrument),
            .text = fmt::format("# {} frames, axis at column {:.2f}\n", film.frames, axis.column)};
    }
    const std::filesystem::path folder = values.path("out");
    check_output_folder(folder, profiles_file, values.flag("overwrite"));
    Outcome outcome;
    write_folder_atomically(folder, values.flag("overwrite"), [&](const auto& inside) {
        std::ofstream profiles(inside / profiles_file, std::ios::binary);
        const OutlineAxis axis = follow_film(
            values, instrument, [&](const std::string& rows) { profiles << rows; }, film, progress);
        if (!profiles.flush())
            throw Error(ErrorCode::output_failed,
                        fmt::format("cannot write '{}': is the disk full?", folder.string()));
        outcome.result = tree_of(film, axis, instrument);
        write_text_file(inside / "result.json", tree_json(outcome.result));
        write_text_file(inside / "contours.html",
                        contours_page(
                            film.strip, fmt::format("Outlines in {} frames", film.frames),
                            tree_html(outcome.result), film.seconds, film.apex_mm,
                            [&](Index frame) { return instrument.time_s(frame); },
                            instrument.pixel_z_um / instrument.pixel_r_um));
    });
    outcome.text =
        tree_text(outcome.result) + fmt::format("page: {}/contours.html\n", folder.string());
    return outcome;
}

}  // namespace palpate
