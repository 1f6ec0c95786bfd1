// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/fields/signed_distance.hpp"

#include <cmath>

#include "host/geometry/fields/line_filter.hpp"

namespace palpate {
namespace {

constexpr float infinite = 1e30f;

/// Lower envelope of the parabolas height[i] + h^2 (x - position[i])^2, built from left to right.
class Envelope {
public:
    Envelope(Index capacity, double h) : h2_(h * h), parabolas_(capacity) {}

    void clear() { count_ = 0; }

    void add(double position, double height) {
        while (count_ > 0) {
            const Parabola& last = parabolas_[count_ - 1];
            const double from = crossing(last, position, height);
            if (from > last.from) {
                parabolas_[count_++] = {position, height, from};
                return;
            }
            --count_;
        }
        parabolas_[count_++] = {position, height, -infinite};
    }

    bool empty() const { return count_ == 0; }

    /// Value at x; calls must come with growing x and the same cursor, which starts at 0.
    double value(double x, Index& cursor) const {
        while (cursor + 1 < count_ && parabolas_[cursor + 1].from < x) ++cursor;
        const Parabola& p = parabolas_[cursor];
        return p.height + h2_ * (x - p.position) * (x - p.position);
    }

private:
    struct Parabola {
        double position, height, from;
    };
    double crossing(const Parabola& p, double position, double height) const {
        return 0.5 * (p.position + position) +
               (height - p.height) / (2 * h2_ * (position - p.position));
    }
    double h2_;
    std::vector<Parabola> parabolas_;
    Index count_ = 0;
};

/// One axis of the squared distance to boxes: out[x] = min over y of in[y] + max(0, |x - y| -
/// 1/2)^2 h^2. The faces of box y are at y +- 1/2; a parabola on the face i + 1/2 carries the lower
/// of in[i], in[i + 1].
void squared_distance_line(float* block, Index length, Envelope& envelope) {
    for (Index w = 0; w < lines_per_block; ++w) {
        float* line = block + w;
        envelope.clear();
        for (Index i = 0; i + 1 < length; ++i) {
            const float height =
                std::min(line[i * lines_per_block], line[(i + 1) * lines_per_block]);
            if (height < infinite) envelope.add(i + 0.5, height);
        }
        if (envelope.empty()) continue;
        Index cursor = 0;
        for (Index i = 0; i < length; ++i) {
            float& value = line[i * lines_per_block];
            value = std::min(value, static_cast<float>(envelope.value(i, cursor)));
        }
    }
}

void squared_distance(const std::array<Index, 3>& size, const Vec3& spacing,
                      std::vector<float>& volume) {
    for (int axis = 0; axis < 3; ++axis) {
        filter_lines(size, axis, volume, [&](float* block, Index length) {
            Envelope envelope(length, spacing[axis]);
            squared_distance_line(block, length, envelope);
        });
    }
}

/// Symmetric Gaussian taps 0..radius for a variance in voxels^2. Narrow ones have three taps with
/// the exact variance: a sampled Gaussian would lose it.
std::vector<double> gaussian_taps(double variance) {
    if (variance < 0.36) return {1 - variance, variance / 2};
    const Index radius = static_cast<Index>(std::ceil(4 * std::sqrt(variance)));
    std::vector<double> taps(radius + 1);
    double sum = 0;
    for (Index i = 0; i <= radius; ++i) {
        taps[i] = std::exp(-0.5 * i * i / variance);
        sum += (i == 0 ? 1 : 2) * taps[i];
    }
    for (double& tap : taps) tap /= sum;
    return taps;
}

/// 2 g - g * g.
std::vector<double> compensated_taps(double variance) {
    const std::vector<double> g = gaussian_taps(variance);
    const Index radius = static_cast<Index>(g.size()) - 1;
    std::vector<double> taps(2 * radius + 1, 0.0);
    for (Index a = -radius; a <= radius; ++a) {
        for (Index b = -radius; b <= radius; ++b) {
            if (a + b >= 0) taps[a + b] -= g[std::abs(a)] * g[std::abs(b)];
        }
    }
    for (Index i = 0; i <= radius; ++i) taps[i] += 2 * g[i];
    return taps;
}

Index mirrored(Index i, Index length) {
    if (length == 1) return 0;
    const Index period = 2 * (length - 1);
    i = ((i % period) + period) % period;
    return i < length ? i : period - i;
}

void convolve_block(const std::vector<double>& taps, float* block, Index length,
                    std::vector<float>& copy) {
    const Index radius = static_cast<Index>(taps.size()) - 1;
    copy.resize(std::size_t(length + 2 * radius) * lines_per_block);
    for (Index k = -radius; k < length + radius; ++k) {
        const float* from = block + std::size_t(mirrored(k, length)) * lines_per_block;
        std::copy(from, from + lines_per_block, &copy[std::size_t(k + radius) * lines_per_block]);
    }
    for (Index k = 0; k < length; ++k) {
        const float* centre = &copy[std::size_t(k + radius) * lines_per_block];
        std::array<float, lines_per_block> sum;
        for (Index w = 0; w < lines_per_block; ++w) sum[w] = float(taps[0]) * centre[w];
        for (Index t = 1; t <= radius; ++t) {
            const float* before = centre - t * lines_per_block;
            const float* after = centre + t * lines_per_block;
            const float tap = static_cast<float>(taps[t]);
            for (Index w = 0; w < lines_per_block; ++w) sum[w] += tap * (before[w] + after[w]);
        }
        std::copy(sum.begin(), sum.end(), block + std::size_t(k) * lines_per_block);
    }
}

}  // namespace

std::vector<float> signed_distance(const std::array<Index, 3>& size, const Vec3& spacing,
                                   const std::vector<std::uint8_t>& mask) {
    std::vector<float> to_inside(mask.size()), to_outside(mask.size());
    for (std::size_t i = 0; i < mask.size(); ++i) {
        to_inside[i] = mask[i] ? 0.f : infinite;
        to_outside[i] = mask[i] ? infinite : 0.f;
    }
    squared_distance(size, spacing, to_inside);
    squared_distance(size, spacing, to_outside);
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const float distance =
            std::min(distance_to_nothing_mm, std::sqrt(mask[i] ? to_outside[i] : to_inside[i]));
        to_inside[i] = mask[i] ? -distance : distance;
    }
    return to_inside;
}

void smooth_without_shrinking(const std::array<Index, 3>& size, const Vec3& spacing,
                              double sigma_mm, std::vector<float>& volume) {
    if (!(sigma_mm > 0)) return;
    for (int axis = 0; axis < 3; ++axis) {
        const double sigma = sigma_mm / spacing[axis];
        const std::vector<double> taps = compensated_taps(sigma * sigma);
        filter_lines(size, axis, volume, [&](float* block, Index length) {
            thread_local std::vector<float> copy;
            convolve_block(taps, block, length, copy);
        });
    }
}

}  // namespace palpate
