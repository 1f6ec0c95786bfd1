// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/aspiration_film.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double rest_mm = 1.0, travel_mm = 1.65;

}  // namespace

const std::vector<FilmScene>& film_suite() {
    static const std::vector<FilmScene> suite{
        {"noise 3", 3, 1, 0, 0, 0, 0},       {"noise 8, light falls 60 %", 8, 1, 0.6, 0, 0, 0},
        {"six glares", 3, 1, 0.3, 6, 0, 0},  {"three bubbles", 3, 1, 0.3, 0, 3, 0},
        {"four stains", 3, 1, 0.3, 0, 0, 4}, {"all of it, blur 1.5", 5, 1.5, 0.4, 5, 2, 3},
    };
    return suite;
}

AspirationFilm::AspirationFilm(const FilmScene& scene, unsigned seed, Index num_frames, Index width,
                               Index height)
    : num_frames_(num_frames),
      width_(width),
      height_(height),
      column_mm_(pixel_r_mm / (double(width) / 180)),
      row_mm_(pixel_z_mm * 180 / double(height)),
      base_row_(double(height) * 150 / 180) {
    RandomNumbers random(0x66696c6dull * 1000003ull + seed);
    tilt_mm_ = random.uniform(-0.1, 0.1);
    look_.emplace(
        scene, seed, width, height, visible_rows(), random, num_frames,
        [this](Index frame, double column) { return edge_row(column, height_mm(frame)); });
}

/// Two fifths of the film up, one fifth held, two fifths down.
double AspirationFilm::height_mm(Index frame) const {
    const double part = num_frames_ > 1 ? double(frame) / double(num_frames_ - 1) : 0;
    const double up = std::clamp(part / 0.4, 0.0, 1.0),
                 down = std::clamp((1 - part) / 0.4, 0.0, 1.0);
    const double share = std::min(up, down);
    return rest_mm + travel_mm * share * share * (3 - 2 * share);
}

// z = h (1 - (r / a)^2)^1.25
double AspirationFilm::edge_row(double column, double cap_mm) const {
    const double r = (column + 0.5 - double(width_) / 2) * column_mm_ - tilt_mm_;
    const double part = 1 - r * r / (0.25 * hole_mm * hole_mm);
    return base_row_ - 0.5 - (part > 0 ? cap_mm * std::pow(part, 1.25) / row_mm_ : 0);
}

std::vector<double> AspirationFilm::outline(Index frame) const {
    std::vector<double> rows;
    for (Index x = 0; x < width_; ++x) rows.push_back(edge_row(double(x), height_mm(frame)));
    return rows;
}

std::vector<std::uint8_t> AspirationFilm::frame(Index frame) const {
    const double cap = height_mm(frame);
    return look_->frame(
        frame, [&](double column) { return edge_row(column, cap); }, base_row_ - cap / row_mm_);
}

}  // namespace palpate
