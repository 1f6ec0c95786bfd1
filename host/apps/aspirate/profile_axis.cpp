// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/profile_axis.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate {
namespace {

constexpr std::size_t most_frames = 60, least_pairs = 100;
constexpr double farthest_mm = 1, step_mm = 0.02, pair_step_mm = 0.25, most_difference_mm = 0.1;
constexpr double longest_gap_mm = 0.3;  // between points

/// The height between two neighbours that have no flag.
std::optional<double> height_at(const FrameProfile& frame, double r_mm) {
    const auto right = std::lower_bound(
        frame.points.begin(), frame.points.end(), r_mm,
        [](const ProfilePoint& point, double wanted_mm) { return point.r_mm < wanted_mm; });
    if (right == frame.points.begin() || right == frame.points.end()) return std::nullopt;
    const ProfilePoint &a = *(right - 1), &b = *right;
    if (a.flag != PointFlag::ok || b.flag != PointFlag::ok || b.r_mm - a.r_mm > longest_gap_mm)
        return std::nullopt;
    return a.z_mm + (r_mm - a.r_mm) / (b.r_mm - a.r_mm) * (b.z_mm - a.z_mm);
}

struct Difference {
    double axis_mm = 0, squares = 0;
    std::size_t num_pairs = 0;
    double mean() const { return squares / double(std::max<std::size_t>(1, num_pairs)); }
};

Difference about(const std::vector<const FrameProfile*>& frames, double axis_mm) {
    Difference sum{axis_mm};
    for (const FrameProfile* frame : frames) {
        if (frame->points.empty()) continue;
        const double end_mm =
            std::min(axis_mm - frame->points.front().r_mm, frame->points.back().r_mm - axis_mm);
        for (double d = pair_step_mm; d <= end_mm; d += pair_step_mm) {
            const auto left = height_at(*frame, axis_mm - d),
                       right = height_at(*frame, axis_mm + d);
            if (!left || !right) continue;
            const double away_mm = std::min(std::abs(*left - *right), most_difference_mm);
            sum.squares += away_mm * away_mm;
            ++sum.num_pairs;
        }
    }
    return sum;
}

}  // namespace

double axis_of(const ProfileSeries& profiles) {
    std::vector<const FrameProfile*> frames;
    const std::size_t every = std::max<std::size_t>(1, profiles.size() / most_frames);
    for (std::size_t k = 0; k < profiles.size(); k += every) frames.push_back(&profiles[k]);
    std::vector<Difference> tried;
    std::size_t most_pairs = 0;
    for (double axis_mm = -farthest_mm; axis_mm <= farthest_mm; axis_mm += step_mm) {
        tried.push_back(about(frames, axis_mm));
        most_pairs = std::max(most_pairs, tried.back().num_pairs);
    }
    if (most_pairs < least_pairs) return 0;
    std::erase_if(tried, [&](const Difference& one) { return 2 * one.num_pairs < most_pairs; });
    const Difference best = *std::min_element(
        tried.begin(), tried.end(),
        [](const Difference& a, const Difference& b) { return a.mean() < b.mean(); });
    return std::sqrt(best.mean()) < 0.5 * most_difference_mm ? best.axis_mm : 0;
}

void move_axis(double axis_mm, ProfileSeries& profiles) {
    for (FrameProfile& frame : profiles)
        for (ProfilePoint& point : frame.points) point.r_mm -= axis_mm;
}

}  // namespace palpate
