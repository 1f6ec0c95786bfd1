// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/aspiration/film_look.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

constexpr Index oversampling = 4;
constexpr double wall = 0.8;  // half of a bubble's wall, pixels
constexpr double glare_grey = 250, bubble_grey = 150, stain_part = 0.35, rim_grey = 70;

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

FilmLook::FilmLook(FilmScene scene, unsigned seed, Index width, Index height, double visible_rows,
                   RandomNumbers& random, Index num_frames,
                   const std::function<double(Index frame, double column)>& edge_of)
    : scene_(std::move(scene)),
      seed_(seed),
      width_(width),
      height_(height),
      scale_(double(width) / 180),
      visible_rows_(visible_rows) {
    for (double& phase : phase_) phase = random.uniform(0, 6.28);
    glares_ = spots(scene_.glares, 3, 12, 2, 6, 1);
    stains_ = spots(scene_.stains, 0, 4, 4, 10, 3);
    bubbles_ = spots(scene_.bubbles, -11, -3, 3, 7, 2);
    for (Spot& bubble : bubbles_) {
        // beside the outline of some frame of the film
        const Index met = Index(random.uniform(0, double(num_frames) - 0.01));
        bubble.y += edge_of(met, bubble.x);
    }
}

std::vector<FilmLook::Spot> FilmLook::spots(int count, double depth_low, double depth_high,
                                            double radius_low, double radius_high,
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

double FilmLook::grey_at(double column, double row, double edge, double apex,
                         const std::vector<Spot>& glares, const std::vector<Spot>& stains) const {
    if (row > visible_rows_) return rim_grey;
    const double x = column / scale_, part = column / double(width_);
    if (row < edge) {
        for (const Spot& bubble : bubbles_) {
            const double away = std::hypot(column - bubble.x, row - bubble.y);
            if (std::abs(away - bubble.radius) < wall) return bubble_grey;
        }
        return 28 + 10 * scene_.falloff * part + 0.05 * row / scale_;
    }
    const double deep = row - edge, y = (row - apex) / scale_;
    for (const Spot& glare : glares)
        if (std::hypot(column - glare.x, row - glare.y) < glare.radius) return glare_grey;
    double grey =
        135 + 10 * std::sin(0.21 * x + phase_[0]) + 8 * std::sin(0.33 * y + 0.1 * x + phase_[1]);
    grey *= 1 - scene_.falloff * part - 0.002 * deep / scale_;
    for (const Spot& stain : stains)
        if (std::hypot(column - stain.x, row - stain.y) < stain.radius) grey *= stain_part;
    return grey;
}

std::vector<std::uint8_t> FilmLook::frame(Index number, const EdgeRow& edge_row,
                                          double apex_row) const {
    std::vector<Spot> glares = glares_, stains = stains_;
    for (auto* list : {&glares, &stains})
        for (Spot& spot : *list) spot.y += edge_row(spot.x);
    std::vector<std::vector<double>> rows(std::size_t(height_),
                                          std::vector<double>(std::size_t(width_), 0.0));
    constexpr double part = 1.0 / oversampling;
    for (Index x = 0; x < width_; ++x)
        for (Index i = 0; i < oversampling; ++i) {
            const double column = double(x) - 0.5 + (double(i) + 0.5) * part;
            const double edge = edge_row(column);
            for (Index y = 0; y < height_; ++y)
                for (Index j = 0; j < oversampling; ++j)
                    rows[y][x] += part * part *
                                  grey_at(column, double(y) - 0.5 + (double(j) + 0.5) * part, edge,
                                          apex_row, glares, stains);
        }
    for (auto& row : rows) blur_line(row, scene_.blur);
    std::vector<double> column(static_cast<std::size_t>(height_));
    for (Index x = 0; x < width_; ++x) {
        for (Index y = 0; y < height_; ++y) column[y] = rows[y][x];
        blur_line(column, scene_.blur);
        for (Index y = 0; y < height_; ++y) rows[y][x] = column[y];
    }
    RandomNumbers random(seed_ * 104729ull + std::uint64_t(number) * 31ull + 5);
    std::vector<std::uint8_t> grey;
    grey.reserve(std::size_t(width_ * height_));
    for (const auto& row : rows)
        for (const double light : row) {
            const double noisy =
                light + scene_.noise * std::sqrt(0.3 + light / 100) * random.normal();
            grey.push_back(std::uint8_t(std::clamp(std::lround(noisy), 0L, 255L)));
        }
    return grey;
}

}  // namespace palpate
