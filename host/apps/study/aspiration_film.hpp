// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/apps/phantom/aspiration/film_look.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// The rows of the suite: noise, noise with falling light, glare, bubbles, blood, all of it.
const std::vector<FilmScene>& film_suite();

/// A film of a silhouette whose outline is a formula: a cap over a hole of 10 mm that rises by
/// 1.65 mm under suction, stays and comes back. Texture, glare and stains move with the tissue,
/// bubbles stand still before the background.
class AspirationFilm {
public:
    static constexpr double pixel_r_mm = 0.0629, pixel_z_mm = 0.03175, hole_mm = 10, rim_mm = 0.5;

    /// `width` x `height` pixels; the optics are those of 180 x 180 pixels, scaled.
    AspirationFilm(const FilmScene& scene, unsigned seed, Index num_frames, Index width = 180,
                   Index height = 180);

    Index width() const { return width_; }
    Index height() const { return height_; }
    Index num_frames() const { return num_frames_; }
    double base_row() const { return base_row_; }  ///< of z = 0
    double visible_rows() const { return base_row_ - rim_mm / row_mm_; }
    /// Row of the outline at the middle of each column [width].
    std::vector<double> outline(Index frame) const;
    /// Rendered four by four times oversampled, rounded to eight bits [height * width].
    std::vector<std::uint8_t> frame(Index frame) const;

private:
    double height_mm(Index frame) const;
    double edge_row(double column, double cap_mm) const;

    Index num_frames_, width_, height_;
    double column_mm_, row_mm_, base_row_, tilt_mm_ = 0;
    std::optional<FilmLook> look_;
};

}  // namespace palpate
