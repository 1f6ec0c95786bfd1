// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/apps/application.hpp"
#include "host/apps/aspirate/film_strip.hpp"
#include "host/apps/aspirate/model/aspiration_settings.hpp"
#include "host/apps/aspirate/profile_writer.hpp"

namespace palpate {

/// What was found in a film.
struct FilmOutlines {
    Index num_frames = 0, num_lost = 0;
    double num_points = 0, num_guessed = 0;  ///< above the line of visibility
    /// Sum over sure points of the grey below the outline less that above, and over how many.
    double contrast = 0, num_compared = 0;
    std::vector<double> time_s = {}, apex_mm = {};  ///< [frames that were seen] the highest point
    FilmStrip strip = {};
    FilmAxis axis = {};
};

/// From the first frame to the last of what the options `frames` and `raw` name; rows of profiles
/// go to `write` as frames come in. Throws Error(invalid_argument) if nothing tells the frames'
/// times, Error(input_unreadable), and Error(input_unusable) for a film without tissue, an outline
/// that is lost in more than a fifth of the frames or has what is brighter on the wrong side, and
/// sides that differ by more than 0.3 mm.
FilmOutlines follow_film(const OptionValues& values, const AspirationInstrument& instrument,
                         const std::function<void(const std::string&)>& write,
                         const ProgressSink& progress);

/// The same into the file `profiles_file` of a folder. Throws Error(output_failed), too.
FilmOutlines write_profiles(const std::filesystem::path& folder, const OptionValues& values,
                            const AspirationInstrument& instrument, const ProgressSink& progress);
constexpr const char* profiles_file = "profiles.csv";

/// Columns of whole frames.
double axis_column_px(const FilmOutlines& film, const AspirationInstrument& instrument);
FilmLines film_lines(const FilmOutlines& film, const AspirationInstrument& instrument);
ResultTree outlines_tree(const FilmOutlines& film, const AspirationInstrument& instrument);

}  // namespace palpate
