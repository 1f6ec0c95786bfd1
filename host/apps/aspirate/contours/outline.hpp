// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// One picture of a camera, rows from the top, pixels of a row side by side.
struct GreyFrame {
    Index width = 0, height = 0;
    std::vector<float> grey;  ///< [height * width], 0 black to 255 white
};

/// How far a point of an outline can be trusted.
enum class PointFlag : std::uint8_t {
    ok,
    guessed,  ///< cues disagree or its neighbours do: the place is what they make of it
    hidden,   ///< below the line of visibility, behind the rim
    lost,     ///< nothing in the column tells tissue from what is behind it
};

/// Whether a column shows tissue, but not surely where.
inline bool is_doubted(PointFlag flag) {
    return flag == PointFlag::guessed || flag == PointFlag::lost;
}

struct OutlinePoint {
    double row = 0;  ///< of the tissue's edge, pixels; a pixel's centre is a whole number
    double sd = 0;   ///< standard deviation, pixels
    PointFlag flag = PointFlag::lost;
};

/// The upper edge of the tissue, a point for each column of the frame.
using Outline = std::vector<OutlinePoint>;

/// What a search for outlines has to know of the frames.
struct ContourSettings {
    Index width = 0, height = 0;  ///< of the frames
    double visible_rows = 0;      ///< rows from here on are behind the rim
    bool is_brighter = true;      ///< tissue, than what is behind it
};

}  // namespace palpate
