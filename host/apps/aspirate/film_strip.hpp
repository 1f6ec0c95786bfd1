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

/// Sections of a page: how far the highest point came, and frames with their outlines.
///   `seconds` and `apex_mm` [frames that were seen]; a row of pixels is `rows_per_column` of a
///   column high on the tissue
std::string film_sections(const FilmStrip& strip, const std::vector<double>& seconds,
                          const std::vector<double>& apex_mm, double rows_per_column);
/// Of these sections.
extern const char* const film_style;

}  // namespace palpate
