// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/profile_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "host/apps/aspirate/median.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_frames = 60, least_pairs = 100;
constexpr double farthest_mm = 1.5, step_mm = 0.02, pair_step_mm = 0.25, most_difference_mm = 0.1;
constexpr double longest_gap_mm = 0.3;  // between points
constexpr double wide_part = 0.5;       // of the hole's radius: nearer pairs hardly tell
constexpr double least_wide_part = 0.1, least_fall = 2, much_mm = 0.02;
constexpr int slope_rounds = 3;
// Of `find_axis`, in radii of the hole
constexpr double pairs_per_radius = 20, found_reach = 0.45, coarse_step = 0.005;
constexpr double found_part = 0.4;  // of half a profile's width, if that is more
constexpr int fine_steps = 10;
constexpr double less_than_askew = 0.8;     // of what any slope leaves: noise alone may be less
constexpr double turned = 0.03, askew = 1;  // slopes: 3 sd of what a fit expects of a camera; any

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

std::vector<const FrameProfile*> not_empty(const ProfileSeries& profiles, std::size_t every) {
    std::vector<const FrameProfile*> frames;
    for (std::size_t k = 0; k < profiles.size(); k += every)
        if (!profiles[k].points.empty()) frames.push_back(&profiles[k]);
    return frames;
}

struct Pair {
    double d_mm, difference_mm;  ///< of the right side over the left
};

std::vector<Pair> pairs_about(const std::vector<const FrameProfile*>& frames, double axis_mm,
                              double apart_mm) {
    std::vector<Pair> pairs;
    for (const FrameProfile* frame : frames) {
        const double end_mm =
            std::min(axis_mm - frame->points.front().r_mm, frame->points.back().r_mm - axis_mm);
        for (double d = apart_mm; d <= end_mm; d += apart_mm) {
            const auto left = height_at(*frame, axis_mm - d),
                       right = height_at(*frame, axis_mm + d);
            if (left && right) pairs.push_back({d, *right - *left});
        }
    }
    return pairs;
}

/// The median of what is left with the slope that leaves least of what is not far away.
double left_by(const std::vector<Pair>& pairs, double most_slope) {
    std::vector<double> slopes;
    for (const auto& [d, difference] : pairs)
        if (most_slope > 0) slopes.push_back(difference / (2 * d));
    double slope = slopes.empty() ? 0 : std::clamp(median(slopes), -most_slope, most_slope);
    for (int round = 0; round < slope_rounds; ++round) {
        double products = 0, squares = 0;
        for (const auto& [d, difference] : pairs) {
            if (std::abs(difference - 2 * slope * d) > most_difference_mm) continue;
            products += 2 * d * difference;
            squares += 4 * d * d;
        }
        if (squares > 0) slope = std::clamp(products / squares, -most_slope, most_slope);
    }
    std::vector<double> left;
    for (const auto& [d, difference] : pairs) left.push_back(std::abs(difference - 2 * slope * d));
    return median(std::move(left));
}

}  // namespace

ProfileAxis axis_at(const ProfileSeries& profiles, double r_mm, double hole_radius_mm) {
    const auto pairs = pairs_about(not_empty(profiles, 1), r_mm, hole_radius_mm / pairs_per_radius);
    double squares = 0;
    for (const Pair& pair : pairs) squares += 0.25 * pair.difference_mm * pair.difference_mm;
    const auto count = Index(pairs.size());
    return {r_mm, count ? std::sqrt(squares / double(count)) : 0, count};
}

ProfileAxis find_axis(const ProfileSeries& profiles, double hole_radius_mm) {
    const auto frames = not_empty(profiles, 1);
    const double pair_mm = hole_radius_mm / pairs_per_radius;
    const auto enough =
        std::max<std::size_t>(least_axis_pairs, pairs_about(frames, 0, pair_mm).size() / 2);
    double reach_mm = found_reach * hole_radius_mm;
    for (const FrameProfile* frame : frames)
        reach_mm = std::max(
            reach_mm, found_part * 0.5 * (frame->points.back().r_mm - frame->points.front().r_mm));
    double best_mm = 0, least = std::numeric_limits<double>::infinity();
    const auto try_at = [&](double r_mm) {
        const auto pairs = pairs_about(frames, r_mm, pair_mm);
        if (pairs.size() < enough) return;
        const double left_mm = left_by(pairs, 0);
        if (left_mm >= least) return;
        least = left_mm;
        best_mm = r_mm;
    };
    // From the middle outwards: of two that are alike the nearer one
    const auto search = [&](double middle_mm, double far_mm, double step_size_mm) {
        try_at(middle_mm);
        for (double d = step_size_mm; d <= far_mm; d += step_size_mm) {
            try_at(middle_mm - d);
            try_at(middle_mm + d);
        }
    };
    const double coarse_mm = coarse_step * hole_radius_mm;
    search(0, reach_mm, coarse_mm);
    search(best_mm, coarse_mm, coarse_mm / fine_steps);
    return axis_at(profiles, best_mm, hole_radius_mm);
}

double axis_of(const ProfileSeries& profiles, double hole_radius_mm) {
    const auto frames =
        not_empty(profiles, std::max<std::size_t>(1, profiles.size() / most_frames));
    const auto is_wide = [&](const Pair& pair) { return pair.d_mm >= wide_part * hole_radius_mm; };
    const auto as_now = pairs_about(frames, 0, pair_step_mm);
    if (as_now.size() < least_pairs) return 0;
    const double now = left_by(as_now, turned);
    if (now < much_mm) return 0;
    double best_mm = 0,
           least = std::min(now / least_fall, less_than_askew * left_by(as_now, askew));
    const int count = int(std::lround(farthest_mm / step_mm));
    for (int k = -count; k <= count; ++k) {
        const auto pairs = pairs_about(frames, k * step_mm, pair_step_mm);
        const auto num_wide = std::count_if(pairs.begin(), pairs.end(), is_wide);
        if (2 * pairs.size() < as_now.size() ||
            double(num_wide) < least_wide_part * double(pairs.size()))
            continue;
        const double left = left_by(pairs, turned);
        if (left >= least) continue;
        least = left;
        best_mm = k * step_mm;
    }
    return std::abs(best_mm) < (count - 0.5) * step_mm ? best_mm : 0;
}

void move_axis(double axis_mm, ProfileSeries& profiles) {
    for (FrameProfile& frame : profiles)
        for (ProfilePoint& point : frame.points) point.r_mm -= axis_mm;
}

}  // namespace palpate
