// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/aspirate/contours/outline.hpp"

namespace palpate {

/// Some frames of a film with their outlines, spread over it, however long it is.
class FilmStrip {
public:
    struct Shown {
        Index number;
        double time_s;
        GreyFrame frame;
        Outline outline;
    };

    void add(const GreyFrame& frame, const Outline& outline, double time_s);
    const std::vector<Shown>& shown() const { return shown_; }

private:
    Index number_ = 0, step_ = 1;
    std::vector<Shown> shown_;
};

/// What is told or found of the instrument, drawn over frames: pixels of what `crop_px` keeps.
struct FilmLines {
    double base_row = 0;     ///< z = 0, the rim's lower face
    double visible_row = 0;  ///< from there on the rim hides the tissue
    double axis_column = 0;
    double rows_per_column = 1;  ///< height of a pixel over its width, on the tissue
};

/// Sections of a page: how far the highest point came, and frames with their outlines.
///   `seconds` and `apex_mm` [frames that were seen], or empty: only the frames
std::string film_sections(const FilmStrip& strip, const std::vector<double>& seconds,
                          const std::vector<double>& apex_mm, const FilmLines& lines);
/// Of these sections.
extern const char* const film_style;

}  // namespace palpate
