// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/apps/phantom/random_numbers.hpp"
#include "solver/base/types.hpp"

namespace palpate {

/// What makes frames of sucked tissue hard to read. Lengths in pixels, light in grey values of 255.
struct FilmScene {
    std::string name;
    double noise = 3;    ///< standard deviation near grey 70; grows with the root of light
    double blur = 1;     ///< of the optics, standard deviation
    double falloff = 0;  ///< part of the light that is lost from left to right
    int glares = 0, bubbles = 0, stains = 0;
};

/// Row of the outline at any column of a frame; a pixel's centre is a whole number.
using EdgeRow = std::function<double(double column)>;

/// How a film of a silhouette looks: texture, glare and stains move with the tissue, bubbles stand
/// still before the background, the rim hides what is below it. The optics are those of 180 x 180
/// pixels, scaled.
class FilmLook {
public:
    /// `random` gives phases and frames at which bubbles are met, the seed all other places.
    ///   edge_of   the outline of a frame of the film
    FilmLook(FilmScene scene, unsigned seed, Index width, Index height, double visible_rows,
             RandomNumbers& random, Index num_frames,
             const std::function<double(Index frame, double column)>& edge_of);

    /// Rendered four by four times oversampled, rounded to eight bits [height * width].
    ///   apex_row   of the outline: texture moves with it
    std::vector<std::uint8_t> frame(Index number, const EdgeRow& edge_row, double apex_row) const;

private:
    struct Spot {
        double x, y, radius;  ///< y from the outline (glare, stains) or from the top (bubbles)
    };
    std::vector<Spot> spots(int count, double depth_low, double depth_high, double radius_low,
                            double radius_high, std::uint64_t salt) const;
    double grey_at(double column, double row, double edge, double apex,
                   const std::vector<Spot>& glares, const std::vector<Spot>& stains) const;

    FilmScene scene_;
    unsigned seed_;
    Index width_, height_;
    double scale_, visible_rows_, phase_[2];
    std::vector<Spot> glares_, bubbles_, stains_;
};

}  // namespace palpate
