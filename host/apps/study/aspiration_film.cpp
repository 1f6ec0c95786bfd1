// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/aspiration_film.hpp"

#include <algorithm>
#include <cmath>

#include "host/apps/phantom/random_numbers.hpp"

namespace palpate {
namespace {

constexpr Index oversampling = 4;
constexpr double rest_mm = 1.0, travel_mm = 1.65;
constexpr double wall = 0.8;  // half of a bubble's wall, pixels
constexpr double glare_grey = 250, bubble_grey = 150, stain_part = 0.35, rim_grey = 70;

/// Box and Muller.
double normal(RandomNumbers& random) {
    return std::sqrt(-2 * std::log(std::max(1e-300, random.uniform(0, 1)))) *
           std::cos(6.283185307179586 * random.uniform(0, 1));
}

/// A line of pixels blurred by a Gaussian; ends repeat.
void blur_line(std::vector<double>& line, double sd) {
    const int reach = int(std::ceil(4 * sd));
    std::vector<double> kernel, out(line.size());
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) {
        kernel.push_back(std::exp(-0.5 * k * k / (sd * sd)));
        sum += kernel.back();
    }
    const int end = int(line.size()) - 1;
    for (int i = 0; i <= end; ++i) {
        double value = 0;
        for (int k = -reach; k <= reach; ++k)
            value += kernel[std::size_t(k + reach)] * line[std::size_t(std::clamp(i + k, 0, end))];
        out[std::size_t(i)] = value / sum;
    }
    line = out;
}

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
    : scene_(scene),
      seed_(seed),
      num_frames_(num_frames),
      width_(width),
      height_(height),
      scale_(double(width) / 180),
      column_mm_(pixel_r_mm / scale_),
      row_mm_(pixel_z_mm * 180 / double(height)),
      base_row_(double(height) * 150 / 180) {
    RandomNumbers random(0x66696c6dull * 1000003ull + seed);
    tilt_mm_ = random.uniform(-0.1, 0.1);
    for (double& phase : phase_) phase = random.uniform(0, 6.28);
    glares_ = spots(scene.glares, 3, 12, 2, 6, 1);
    stains_ = spots(scene.stains, 0, 4, 4, 10, 3);
    bubbles_ = spots(scene.bubbles, -11, -3, 3, 7, 2);
    for (Spot& bubble : bubbles_) {
        // beside the outline of some frame of the film
        const Index met = Index(random.uniform(0, double(num_frames) - 0.01));
        bubble.y += edge_row(bubble.x, height_mm(met));
    }
}

std::vector<AspirationFilm::Spot> AspirationFilm::spots(int count, double depth_low,
                                                        double depth_high, double radius_low,
                                                        double radius_high,
                                                        std::uint64_t salt) const {
    RandomNumbers random(seed_ * 7919ull + salt);
    std::vector<Spot> list;
    for (int k = 0; k < count; ++k) {
        const double x = scale_ * random.uniform(40, 140);
        const double y = random.uniform(depth_low, depth_high);
        list.push_back({x, y, random.uniform(radius_low, radius_high)});
    }
    return list;
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

double AspirationFilm::grey_at(double column, double row, double edge, double apex,
                               Index frame) const {
    if (row > visible_rows()) return rim_grey;
    const double x = column / scale_, part = column / double(width_);
    if (row < edge) {
        for (const Spot& bubble : bubbles_) {
            const double away = std::hypot(column - bubble.x, row - bubble.y);
            if (std::abs(away - bubble.radius) < wall) return bubble_grey;
        }
        return 28 + 10 * scene_.falloff * part + 0.05 * row / scale_;
    }
    const double deep = row - edge, y = (row - apex) / scale_;
    for (const Spot& glare : glares_) {
        const double at = edge_row(glare.x, height_mm(frame)) + glare.y;
        if (std::hypot(column - glare.x, row - at) < glare.radius) return glare_grey;
    }
    double grey =
        135 + 10 * std::sin(0.21 * x + phase_[0]) + 8 * std::sin(0.33 * y + 0.1 * x + phase_[1]);
    grey *= 1 - scene_.falloff * part - 0.002 * deep / scale_;
    for (const Spot& stain : stains_) {
        const double at = edge_row(stain.x, height_mm(frame)) + stain.y;
        if (std::hypot(column - stain.x, row - at) < stain.radius) grey *= stain_part;
    }
    return grey;
}

std::vector<std::uint8_t> AspirationFilm::frame(Index frame) const {
    const double cap = height_mm(frame);
    const double apex = base_row_ - cap / row_mm_;
    std::vector<std::vector<double>> rows(std::size_t(height_),
                                          std::vector<double>(std::size_t(width_), 0.0));
    constexpr double part = 1.0 / oversampling;
    for (Index x = 0; x < width_; ++x)
        for (Index i = 0; i < oversampling; ++i) {
            const double column = double(x) - 0.5 + (double(i) + 0.5) * part;
            const double edge = edge_row(column, cap);
            for (Index y = 0; y < height_; ++y)
                for (Index j = 0; j < oversampling; ++j)
                    rows[y][x] += part * part *
                                  grey_at(column, double(y) - 0.5 + (double(j) + 0.5) * part, edge,
                                          apex, frame);
        }
    for (auto& row : rows) blur_line(row, scene_.blur);
    std::vector<double> column(static_cast<std::size_t>(height_));
    for (Index x = 0; x < width_; ++x) {
        for (Index y = 0; y < height_; ++y) column[y] = rows[y][x];
        blur_line(column, scene_.blur);
        for (Index y = 0; y < height_; ++y) rows[y][x] = column[y];
    }
    RandomNumbers random(seed_ * 104729ull + std::uint64_t(frame) * 31ull + 5);
    std::vector<std::uint8_t> grey;
    grey.reserve(std::size_t(width_ * height_));
    for (const auto& row : rows)
        for (const double light : row) {
            const double noisy =
                light + scene_.noise * std::sqrt(0.3 + light / 100) * normal(random);
            grey.push_back(std::uint8_t(std::clamp(std::lround(noisy), 0L, 255L)));
        }
    return grey;
}

}  // namespace palpate
