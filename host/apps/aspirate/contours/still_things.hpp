// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// What stands still before the background, as bubbles on a mirror do while tissue moves: for each
/// pixel the mean of what it showed beyond the background while it was above the outline.
class StillThings {
public:
    StillThings(Index width, Index rows, Index stride);

    /// Learns from the rows above `top` [width].
    ///   smooth   [width][stride] grey values beyond the background
    void learn(const std::vector<float>& smooth, const std::vector<float>& top);
    /// Takes away evidence of the pixels of a column that show what was there before.
    ///   evidence   [rows]
    void hush(Index x, const float* smooth, float sigma, float* evidence) const;

private:
    Index width_, rows_, stride_;
    std::vector<float> mean_, share_;  ///< [width][stride]; weight of the next frame
};

}  // namespace palpate
