// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/published_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr std::array<float, 3> taps{0.833812F, -0.229945F, 0.0420264F};
constexpr float from_threshold = 1, from_neighbour = 1.5F, of_gradient = 0.3F;
constexpr float not_an_edge = 10, least_gradient = 12;
constexpr Index box_half_width = 15, box_rows = 12, most_passes = 4;
constexpr Index reach = 4;             // of derivative and suppression
constexpr double half_pixel = 0.2887;  // 1 / sqrt(12): whole rows are all it gives

}  // namespace

PublishedOutline::PublishedOutline(const ContourSettings& settings)
    : settings_(settings),
      lowest_(std::clamp<Index>(Index(std::floor(settings.visible_rows)) - 1, 0,
                                settings.height - reach)) {
    const auto num_pixels = std::size_t(settings.width * settings.height);
    grey_.resize(num_pixels);
    size_.resize(num_pixels);
    is_tissue_.resize(num_pixels);
    is_edge_.resize(num_pixels);
    outline_.resize(std::size_t(settings.width));
}

// T = sum(e I) / sum(e), e the larger of the differences across a pixel in x and y
float PublishedOutline::statistic(Index x0, Index x1, Index y0, Index y1) const {
    double weighted = 0, weights = 0;
    for (Index y = std::max<Index>(1, y0); y < std::min(settings_.height - 1, y1); ++y)
        for (Index x = std::max<Index>(1, x0); x < std::min(settings_.width - 1, x1); ++x) {
            const float e = std::max(std::abs(at(x - 1, y) - at(x + 1, y)),
                                     std::abs(at(x, y - 1) - at(x, y + 1)));
            weighted += double(e) * at(x, y);
            weights += e;
        }
    return weights > 0 ? float(weighted / weights) : 128.0F;
}

Index PublishedOutline::first_tissue(Index x) const {
    for (Index y = 2; y < lowest_; ++y)
        if (is_tissue_[y * settings_.width + x] && is_tissue_[(y + 1) * settings_.width + x])
            return y;
    return lowest_;
}

void PublishedOutline::threshold() {
    const Index width = settings_.width;
    const float whole = statistic(0, width, 0, lowest_);
    for (std::size_t n = 0; n < grey_.size(); ++n) is_tissue_[n] = grey_[n] > whole;
    Index left = -1, right = -1;
    for (Index pass = 0; pass < most_passes; ++pass) {
        Index first = width, last = -1;
        for (Index x = 0; x < width; ++x)
            if (first_tissue(x) < lowest_) {
                first = std::min(first, x);
                last = x;
            }
        if (last < 0 || (first == left && last == right)) return;
        left = first;
        right = last;
        for (const Index end : {left, right}) {
            const Index x0 = std::max<Index>(0, end - box_half_width);
            const Index x1 = std::min(width, end + box_half_width);
            const Index y0 = std::max<Index>(0, first_tissue(end) - box_rows);
            const float inside = statistic(x0, x1, y0, lowest_);
            for (Index y = y0; y < lowest_; ++y)
                for (Index x = x0; x < x1; ++x) is_tissue_[y * width + x] = at(x, y) > inside;
        }
    }
}

void PublishedOutline::find_edges() {
    const Index width = settings_.width;
    std::fill(is_edge_.begin(), is_edge_.end(), std::uint8_t(0));
    const auto derivative = [&](Index n, Index step) {
        float sum = 0;
        for (Index k = 0; k < 3; ++k)
            sum += taps[k] * (grey_[n + (k + 1) * step] - grey_[n - (k + 1) * step]);
        return sum;
    };
    const Index end = std::min(lowest_ + 1, settings_.height - 3);
    for (Index y = 3; y < end; ++y)
        for (Index x = 3; x < width - 3; ++x) {
            const Index n = y * width + x;
            size_[n] = std::hypot(derivative(n, 1), derivative(n, width));
        }
    for (Index y = reach; y < std::min(lowest_, settings_.height - reach); ++y)
        for (Index x = reach; x < width - reach; ++x) {
            const Index n = y * width + x;
            if (size_[n] < least_gradient) continue;
            const float gx = derivative(n, 1), gy = derivative(n, width);
            const float ax = std::abs(gx), ay = std::abs(gy);
            constexpr float steep = 2.4142F;  // tan 67.5 degrees
            const Index along = ay > steep * ax   ? width
                                : ax > steep * ay ? 1
                                : gx * gy > 0     ? width + 1
                                                  : width - 1;
            is_edge_[n] = size_[n] >= size_[n + along] && size_[n] > size_[n - along];
        }
}

const Outline& PublishedOutline::add(const GreyFrame& frame) {
    if (frame.width != settings_.width || frame.height != settings_.height)
        throw Error(ErrorCode::input_unusable,
                    "a frame of " + std::to_string(frame.width) + " x " +
                        std::to_string(frame.height) + " pixels among frames of " +
                        std::to_string(settings_.width) + " x " + std::to_string(settings_.height));
    for (std::size_t n = 0; n < grey_.size(); ++n)
        grey_[n] = settings_.is_brighter ? frame.grey[n] : 255 - frame.grey[n];
    threshold();
    find_edges();
    float last = -1;
    for (Index x = 0; x < settings_.width; ++x) {
        const Index guess = first_tissue(x);
        outline_[x] = {double(guess), half_pixel,
                       guess < lowest_ ? PointFlag::ok : PointFlag::hidden};
        if (guess >= lowest_ || x < reach || x >= settings_.width - reach) continue;
        const auto cost = [&](Index y) {
            return from_threshold * float(std::abs(y - guess)) +
                   (last >= 0 ? from_neighbour * std::abs(float(y) - last) : 0) -
                   of_gradient * size_[y * settings_.width + x];
        };
        float least = cost(std::max(guess, Index(3))) + not_an_edge;
        for (Index y = reach; y < lowest_; ++y)
            if (is_edge_[y * settings_.width + x] && cost(y) < least) {
                least = cost(y);
                outline_[x].row = double(y);
            }
        last = float(outline_[x].row);
    }
    return outline_;
}

}  // namespace palpate
