// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/apps/aspirate/contours/outline.hpp"

namespace palpate {

/// Some frames of a film with their outlines, spread over it, however long it is.
class FilmStrip {
public:
    struct Shown {
        Index number;
        GreyFrame frame;
        Outline outline;
    };

    void add(const GreyFrame& frame, const Outline& outline);
    const std::vector<Shown>& shown() const { return shown_; }

private:
    Index number_ = 0, step_ = 1;
    std::vector<Shown> shown_;
};

/// contours.html: frames with outlines, and the highest point over time.
///   headline   HTML; `seconds` and `apex_mm` [frames that were seen]
std::string contours_page(const FilmStrip& strip, const std::string& headline,
                          const std::string& figures, const std::vector<double>& seconds,
                          const std::vector<double>& apex_mm,
                          const std::function<double(Index)>& time_s, double rows_per_column);

}  // namespace palpate
