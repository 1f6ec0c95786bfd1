// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "host/apps/aspirate/contours/outline.hpp"

namespace palpate {

/// The outline as Vuskovic and Kauer find it, frame by frame and in whole pixels: a threshold from
/// simple image statistics, again in a rectangle at either end of the tissue; a derivative of seven
/// taps with non-maximum suppression; then from left to right the edge pixel that costs least,
///     C = a1 |y - f_t(x)| + a2 |y - f(x - 1)| - a3 |grad I|,
/// where the threshold's own outline f_t is a candidate that costs `Const` more. Their weights are
/// not printed; ours are a1 = 1, a2 = 1.5, a3 = 0.3, Const = 10 and a threshold of 12 of 255.
/// A baseline: points have no error of their own and no flags but `hidden`.
class PublishedOutline {
public:
    explicit PublishedOutline(const ContourSettings& settings);

    /// Valid until the next call. Throws Error(input_unusable) for a frame of another size.
    const Outline& add(const GreyFrame& frame);

private:
    float statistic(Index x0, Index x1, Index y0, Index y1) const;
    void threshold();
    void find_edges();
    Index first_tissue(Index x) const;
    float at(Index x, Index y) const { return grey_[y * settings_.width + x]; }

    ContourSettings settings_;
    Index lowest_;  ///< rows from here on are not searched
    std::vector<float> grey_, size_;
    std::vector<std::uint8_t> is_tissue_, is_edge_;
    Outline outline_;
};

}  // namespace palpate
