// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/fit_input.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "host/apps/aspirate/median.hpp"
#include "host/apps/aspirate/profile_axis.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

// Bins have so many points of a profile at least, and are half a millimetre wide if that is more
constexpr double points_in_bin = 5, least_bin_mm = 0.5, most_bin_mm = 1;
constexpr double apex_half_mm = 0.75;  // of the axis: what the highest part is
constexpr double above_rim_mm = 0.12;  // points nearer to the line of visibility are left out
constexpr double most_leverage = 4;    // of a height at a bin's middle, in variances of a point
constexpr Index least_in_bin = 4, least_frames = 8, least_at_r = 4;
constexpr double most_side_difference_mm = 0.3, least_travel_mm = 0.05;
constexpr double begin_tolerance_s = 1e-6, rest_part = 0.03;
constexpr double long_gap = 5;            // times the usual distance
constexpr double weak_suction_kpa = 1.2;  // 12 mbar: what usual kPa are, read as mbar
constexpr double first_mm = 0.25, first_part = 0.3;
// e^(gamma x) is how much stiffer tissue is at the peak, x = 1.3 (travel / hole radius)^2
constexpr double stretch_factor = 1.3;

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::input_unusable, why); }

/// The height at the middle of a bin by the weighted parabola through its points: a straight line
/// is 0.01 mm^2 of the curvature off, which is 6 um beside the wall.
std::optional<ThinPoint> height_near(const FrameProfile& frame, double r_mm, double half_mm,
                                     double lowest_mm) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double variances = 0;
    Index count = 0, all = 0;
    for (const ProfilePoint& point : frame.points) {
        const double x = (point.r_mm - r_mm) / half_mm;
        if (std::abs(x) > 1) continue;
        ++all;
        if (point.flag != PointFlag::ok || point.z_mm < lowest_mm) continue;
        const double w = 1 / (point.sd_mm * point.sd_mm);
        const Eigen::Vector3d terms(1, x, x * x);
        normal += w * terms * terms.transpose();
        right += w * point.z_mm * terms;
        variances += w * point.sd_mm * point.sd_mm;
        ++count;
    }
    if (count < least_in_bin || 2 * count < all) return std::nullopt;
    // z = c0 + c1 x + c2 x^2 has the variance N^-1_00 at x = 0 if errors were independent
    const auto factors = normal.ldlt();
    const Eigen::Vector3d at_middle = factors.solve(Eigen::Vector3d::UnitX());
    if (!(factors.rcond() > 1e-9)) return std::nullopt;
    // Errors of neighbours go together: the sd is at least that of a point. Beyond the points'
    // ends it is more.
    const double point_variance = variances / normal(0, 0);
    if (at_middle[0] > most_leverage * point_variance) return std::nullopt;
    return ThinPoint{0, r_mm, at_middle.dot(right),
                     std::sqrt(std::max(point_variance, at_middle[0]))};
}

std::vector<FrameProfile> frames_at_rest(const ProfileSeries& profiles, const Suction& suction,
                                         double begin_s, double delay_s) {
    std::vector<FrameProfile> rest;
    for (const FrameProfile& frame : profiles)
        if (frame.time_s - delay_s <= begin_s + begin_tolerance_s) rest.push_back(frame);
    if (!rest.empty()) return rest;
    for (const FrameProfile& frame : profiles)
        if (suction.at(frame.time_s - delay_s) < rest_part * suction.peak_kpa() &&
            frame.time_s == profiles.front().time_s)
            return {frame};
    refuse(
        "no frame shows the tissue before suction begins; begin to film earlier, or correct the "
        "times of the suction");
}

void warn_of_gaps(const std::vector<double>& times, const std::string& what,
                  std::vector<std::string>& warnings) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < times.size(); ++k) steps.push_back(times[k] - times[k - 1]);
    if (steps.size() < 4) return;
    const double usual = median(steps);
    const auto worst = std::max_element(steps.begin(), steps.end());
    if (*worst > long_gap * usual)
        warnings.push_back(fmt::format("{} have a gap of {:.2g} s at {:.4g} s", what, *worst,
                                       times[std::size_t(worst - steps.begin())]));
}

/// The frames nearest to the times of the steps, each once.
std::vector<const FrameProfile*> chosen_frames(const ProfileSeries& profiles,
                                               const SuctionSteps& steps, double begin_s,
                                               double delay_s) {
    std::vector<const FrameProfile*> chosen;
    for (const double step_s : steps.time_s) {
        const double wanted = begin_s + step_s + delay_s;
        const auto after = std::lower_bound(
            profiles.begin(), profiles.end(), wanted,
            [](const FrameProfile& frame, double time_s) { return frame.time_s < time_s; });
        auto nearest = after == profiles.end() ? std::prev(after) : after;
        if (after != profiles.begin() && after != profiles.end() &&
            wanted - std::prev(after)->time_s < after->time_s - wanted)
            nearest = std::prev(after);
        if (nearest->time_s <= begin_s + delay_s + begin_tolerance_s) continue;
        if (chosen.empty() || chosen.back()->time_s < nearest->time_s) chosen.push_back(&*nearest);
    }
    return chosen;
}

ApexTravel travel_of(const ProfileSeries& profiles, const Suction& suction, const RestSurface& rest,
                     const AspirationSettings& settings, double begin_s) {
    ApexTravel apex;
    for (const FrameProfile& frame : profiles) {
        const auto height =
            height_near(frame, 0, apex_half_mm, settings.instrument.rim_thickness_mm);
        if (!height) continue;
        apex.time_s.push_back(frame.time_s - begin_s);
        apex.travel_mm.push_back(height->z_mm - rest.z_mm.front());
        apex.suction_kpa.push_back(suction.at(frame.time_s - settings.delay_s.value));
    }
    return apex;
}

TissueStart start_of(const ApexTravel& apex, double hole_radius_mm) {
    const auto highest = std::max_element(apex.travel_mm.begin(), apex.travel_mm.end());
    const double most_mm = *highest;
    const auto peak = std::size_t(highest - apex.travel_mm.begin());
    const double first = std::min(first_mm, first_part * most_mm);
    // suction over travel of the first quarter millimetre, a line through the origin
    double products = 0, squares = 0;
    for (std::size_t k = 0; k <= peak; ++k) {
        if (apex.travel_mm[k] > first && squares > 0) break;
        products += apex.travel_mm[k] * apex.suction_kpa[k];
        squares += apex.travel_mm[k] * apex.travel_mm[k];
    }
    TissueStart start;
    start.peak_stiffness_kpa =
        theret_stiffness(std::max(apex.suction_kpa[peak], 1e-3), hole_radius_mm, most_mm);
    const double first_kpa = squares > 0 && products > 0
                                 ? theret_stiffness(products / squares, hole_radius_mm, 1)
                                 : start.peak_stiffness_kpa;
    const double strain = stretch_factor * std::pow(most_mm / hole_radius_mm, 2);
    start.gamma = std::clamp(std::log(start.peak_stiffness_kpa / first_kpa) / strain, 1.0, 25.0);
    start.mu_kpa = 1.5 * std::min(first_kpa, start.peak_stiffness_kpa) / 6;
    return start;
}

double asymmetry_of(const std::vector<ThinPoint>& points) {
    double squares = 0, count = 0;
    for (const ThinPoint& left : points) {
        if (left.r_mm >= 0) continue;
        for (const ThinPoint& right : points)
            if (right.time_s == left.time_s && std::abs(right.r_mm + left.r_mm) < 1e-9) {
                squares += std::pow(0.5 * (right.z_mm - left.z_mm), 2);
                ++count;
            }
    }
    return count > 0 ? std::sqrt(squares / count) : 0;
}

/// From the usual distance of the points of a frame.
double bin_of(const ProfileSeries& profiles) {
    std::vector<double> apart_mm;  // of neighbours: gaps of points that are left out do not count
    for (const FrameProfile& frame : profiles) {
        std::vector<double> here_mm;
        for (std::size_t k = 1; k < frame.points.size(); ++k)
            here_mm.push_back(frame.points[k].r_mm - frame.points[k - 1].r_mm);
        if (!here_mm.empty()) apart_mm.push_back(median(here_mm));
    }
    const double usual_mm = apart_mm.empty() ? 0 : median(apart_mm);
    const double bin_mm = std::max(least_bin_mm, points_in_bin * usual_mm);
    if (bin_mm > most_bin_mm)
        refuse(
            fmt::format("the points of a profile are {:.2g} mm apart; {:g} mm or closer are "
                        "needed",
                        usual_mm, most_bin_mm / points_in_bin));
    return bin_mm;
}

/// Means of the heights over the frames at rest, at their mean time. What a model has wrong is
/// nothing there: data that leave this out may be met by a model that is off by as much at all
/// times.
void take_rest(const std::vector<FrameProfile>& frames, double lowest_mm, double bin_mm, int bins,
               AspirationFitInput& input) {
    double time_s = 0;
    for (const FrameProfile& frame : frames)
        time_s += (frame.time_s - input.begin_s) / double(frames.size());
    for (int k = -bins; k <= bins; ++k) {
        ThinPoint sum{time_s, k * bin_mm, 0, 0};
        std::size_t count = 0;
        for (const FrameProfile& frame : frames)
            if (const auto height = height_near(frame, k * bin_mm, 0.5 * bin_mm, lowest_mm)) {
                sum.z_mm += height->z_mm;
                sum.sd_mm += height->sd_mm;
                ++count;
            }
        if (2 * count < frames.size() || count == 0) continue;
        sum.z_mm /= double(count);
        sum.sd_mm /= double(count);
        input.points.push_back(sum);
    }
}

/// The largest r at which enough rows are: a bubble here or there is no tissue.
double farthest_seen_mm(const std::vector<ThinPoint>& points, double bin_mm, int bins) {
    for (int k = bins; k > 0; --k)
        if (std::count_if(points.begin(), points.end(), [&](const ThinPoint& point) {
                return std::abs(std::abs(point.r_mm) - k * bin_mm) < 1e-9;
            }) >= least_at_r)
            return k * bin_mm;
    return 0;
}

void take_points(const ProfileSeries& profiles, const std::vector<FrameProfile>& at_rest,
                 const AspirationSettings& settings, AspirationFitInput& input) {
    const double lowest_mm = settings.instrument.rim_thickness_mm + above_rim_mm;
    const double radius_mm = 0.5 * settings.hole_diameter_mm.value;
    const auto frames = chosen_frames(profiles, input.steps, input.begin_s, settings.delay_s.value);
    const double bin_mm = bin_of(profiles);
    const int bins = int(radius_mm / bin_mm);
    take_rest(at_rest, lowest_mm, bin_mm, bins, input);
    for (const FrameProfile* frame : frames) {
        bool is_used = false;
        for (int k = -bins; k <= bins; ++k) {
            auto height = height_near(*frame, k * bin_mm, 0.5 * bin_mm, lowest_mm);
            if (!height) continue;
            height->time_s = frame->time_s - input.begin_s;
            input.points.push_back(*height);
            is_used = true;
        }
        input.num_used_frames += is_used;
    }
    if (input.num_used_frames < least_frames)
        refuse(
            fmt::format("only {} of {} frames show tissue above the line of visibility while it "
                        "is sucked; at least {} are needed",
                        input.num_used_frames, frames.size(), least_frames));
    input.seen_later_to_mm = farthest_seen_mm(input.points, bin_mm, bins);
    input.asymmetry_mm = asymmetry_of(input.points);
    if (input.asymmetry_mm > most_side_difference_mm)
        refuse(
            fmt::format("the tissue's sides differ by {:.2f} mm about the axis; allowed: {:g}; "
                        "put the tube on straight, or correct the axis",
                        input.asymmetry_mm, most_side_difference_mm));
}

void warn_of_rest(const FoundRest& rest, std::vector<std::string>& warnings) {
    if (!rest.is_seen)
        warnings.push_back(
            "before suction no tissue is seen above the line of visibility: it is taken as level "
            "with the rim");
    else if (rest.left_rms_mm > 0.05)
        warnings.push_back(
            fmt::format("the surface before suction is not smooth: {:.3f} mm are "
                        "left of a smooth one",
                        rest.left_rms_mm));
}

/// The first frames alone tell a wrong axis where something in them hides a side.
void centre(const AspirationSettings& settings, ProfileSeries& profiles,
            AspirationFitInput& input) {
    if (settings.instrument.axis_column_px) return;
    const double axis_mm = axis_of(profiles, 0.5 * settings.hole_diameter_mm.value);
    if (std::abs(axis_mm) <= found_axis_sd_mm) return;
    move_axis(axis_mm, profiles);
    input.axis_mm = axis_mm;
    input.warnings.push_back(fmt::format(
        "both sides are most alike at r = {:.2f} mm, so that the axis is taken to be "
        "there; tell axis_column_px if this is wrong (any column, if the profiles are of "
        "no film: r = 0 is the axis then)",
        axis_mm));
}

}  // namespace

std::string AspirationFitInput::points_csv() const {
    std::string text = "time_s,r_mm,z_mm,sd_mm\n";
    for (const ThinPoint& point : points)
        fmt::format_to(std::back_inserter(text), "{:.5f},{:.4f},{:.6f},{:.6f}\n", point.time_s,
                       point.r_mm, point.z_mm, point.sd_mm);
    return text;
}

AspirationFitInput make_fit_input(const ProfileSeries& profiles, const Suction& suction,
                                  const AspirationSettings& settings) {
    AspirationFitInput input;
    input.begin_s = suction.begin_s();
    input.num_frames = Index(profiles.size());
    const double delay_s = settings.delay_s.value;
    ProfileSeries within;
    std::vector<double> times;
    double points = 0, flagged = 0;
    for (const FrameProfile& frame : profiles) {
        if (frame.time_s - delay_s > suction.end_s() + begin_tolerance_s) continue;
        within.push_back(frame);
        times.push_back(frame.time_s);
        for (const ProfilePoint& point : frame.points) {
            if (point.flag == PointFlag::hidden) continue;
            ++points;
            flagged += point.flag != PointFlag::ok;
        }
    }
    input.flagged_percent = 100 * flagged / std::max(1.0, points);
    centre(settings, within, input);
    if (within.empty() || within.back().time_s - delay_s <= input.begin_s)
        refuse(fmt::format(
            "suction and film do not overlap: suction begins at {:g} s and is read until {:g} s, "
            "frames are from {:g} to {:g} s; correct the times of the frames, or delay_s",
            input.begin_s, suction.end_s(), profiles.empty() ? 0 : profiles.front().time_s,
            profiles.empty() ? 0 : profiles.back().time_s));
    if (suction.peak_kpa() < weak_suction_kpa)
        input.warnings.push_back(
            fmt::format("the largest suction is only {:.3g} mbar ({:.3g} kPa); check the unit of "
                        "its column",
                        suction.peak_kpa() / kpa_per_mbar, suction.peak_kpa()));
    if (within.size() < profiles.size())
        input.warnings.push_back(
            fmt::format("{} frames are from after the last reading of suction "
                        "and are left out",
                        profiles.size() - within.size()));
    warn_of_gaps(times, "frames", input.warnings);
    warn_of_gaps(suction.time_s, "readings of suction", input.warnings);
    const double radius_mm = 0.5 * settings.hole_diameter_mm.value;
    const std::vector<FrameProfile> at_rest =
        frames_at_rest(within, suction, input.begin_s, delay_s);
    input.rest = find_rest(at_rest, settings.instrument.rim_thickness_mm + above_rim_mm, radius_mm,
                           settings.edge_radius_mm.value);
    warn_of_rest(input.rest, input.warnings);
    input.steps = suction_steps(suction, within.back().time_s - delay_s, settings.steps);
    take_points(within, at_rest, settings, input);
    input.apex = travel_of(within, suction, input.rest.surface, settings, input.begin_s);
    if (input.apex.travel_mm.empty() ||
        *std::max_element(input.apex.travel_mm.begin(), input.apex.travel_mm.end()) <
            least_travel_mm)
        refuse(
            fmt::format("the tissue does not move by {:g} mm under the suction; look at the "
                        "outlines (palpate aspirate contours): the rim has to be below, and "
                        "base_row_px, tissue and the times of film and suction right",
                        least_travel_mm));
    input.start = start_of(input.apex, radius_mm);
    return input;
}

}  // namespace palpate
