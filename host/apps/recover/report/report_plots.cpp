// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/report_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/apps/recover/report/findings.hpp"
#include "host/page/interval_chart.hpp"
#include "host/page/markup.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

/// Half the 0.95 quantile of chi-square with one degree of freedom.
constexpr double objective_at_95_percent = 1.92;

struct Extent {
    double low = INFINITY, high = -INFINITY;
    void add(double v) {
        if (!std::isfinite(v)) return;
        low = std::min(low, v);
        high = std::max(high, v);
    }
    bool empty() const { return low > high; }
};

bool shown_in_intervals(const RegionResult& r) {
    return !r.hollow && r.stiffness_kpa > 0 && std::isfinite(r.stiffness_kpa);
}

bool has_interval(const RegionResult& r) {
    return r.unknown && r.interval_kpa[0] > 0 && std::isfinite(r.interval_kpa[1]) &&
           r.interval_kpa[1] > r.interval_kpa[0];
}

std::string figure(const std::string& svg, const std::string& caption) {
    return "<figure>" + svg + "<figcaption>" + escape_html(caption) + "</figcaption></figure>";
}

const RegionResult* find_region(const RecoveryResult& result, Index region) {
    for (const RegionResult& r : result.regions)
        if (r.region == region) return &r;
    return nullptr;
}

PlotAxis stiffness_axis(Extent extent, double room) {
    return {extent.low / room, extent.high * room, true, "Young's modulus E, kPa"};
}

std::string profile_figure(const RecoveryResult& result, const ProfileResult& p) {
    Extent x, y;
    for (double v : p.stiffness_kpa) x.add(v);
    for (double v : p.objective) y.add(v);
    if (x.empty() || y.empty() || !(x.low > 0) || x.high <= x.low) return "";
    const std::string name = region_name(result, p.region);
    const std::string colour = region_colour(result, p.region);
    Plot plot(fmt::format("profile-{}", p.region), 420, 260, stiffness_axis(x, 1.0),
              {0, std::clamp(1.05 * y.high, 2.5, 8.0), false, "objective above its minimum"});
    const RegionResult* r = find_region(result, p.region);
    const bool has_number = r && is_known(*r);
    if (r && has_interval(*r)) plot.band(r->interval_kpa[0], r->interval_kpa[1], colour);
    if (has_number)
        plot.vertical_rule(r->stiffness_kpa, significant(r->stiffness_kpa) + " kPa", colour);
    plot.horizontal_rule(objective_at_95_percent, "1.92: 95 %");
    plot.curve(p.stiffness_kpa, p.objective, colour, true);
    const char* shade = has_number
                            ? "Line and shade: the modulus that is told and its 95 % interval, for "
                              "which the images are believed less than the curve does."
                            : "Shade: what the modulus may be, whatever the curve says.";
    return figure(plot.svg("Profile of the objective over the modulus of " + name),
                  fmt::format("{}: objective over E, everything else fitted again, lowest at the "
                              "most probable E. {}",
                              name, shade));
}

std::string objective_figure(const std::vector<IterationRecord>& records) {
    std::vector<double> iteration, objective;
    Extent y;
    for (const IterationRecord& r : records) {
        iteration.push_back(r.iteration);
        objective.push_back(r.objective);
        y.add(r.objective);
    }
    if (y.empty()) return "";
    const bool logarithmic = y.low > 0 && y.high > 20 * y.low;
    const double room = y.high > y.low ? 0.06 * (y.high - y.low) : std::abs(y.high) + 1;
    const PlotAxis axis = logarithmic ? PlotAxis{y.low / 1.3, y.high * 1.3, true, "objective"}
                                      : PlotAxis{y.low - room, y.high + room, false, "objective"};
    Plot plot(
        "convergence-objective", 420, 260,
        {iteration.front(), std::max(iteration.back(), iteration.front() + 1), false, "iteration"},
        axis);
    plot.curve(iteration, objective, "var(--accent)", true);
    return figure(plot.svg("Objective over the iterations"), "Objective at each iteration.");
}

std::string moduli_figure(const RecoveryResult& result) {
    const auto& records = result.convergence;
    std::vector<Index> unknown;
    for (const RegionResult& r : result.regions)
        if (r.unknown) unknown.push_back(r.region);
    Extent y;
    std::vector<double> iteration;
    for (const IterationRecord& r : records) {
        iteration.push_back(r.iteration);
        for (double e : r.stiffness_kpa)
            if (e > 0) y.add(e);
    }
    if (unknown.empty() || y.empty()) return "";
    PlotAxis axis = stiffness_axis(y, 1.25);
    axis.label = "E, kPa";
    Plot plot(
        "convergence-moduli", 420, 260,
        {iteration.front(), std::max(iteration.back(), iteration.front() + 1), false, "iteration"},
        axis);
    std::string names;
    for (std::size_t u = 0; u < unknown.size(); ++u) {
        std::vector<double> values;
        for (const IterationRecord& r : records)
            values.push_back(u < r.stiffness_kpa.size() ? r.stiffness_kpa[u] : NAN);
        plot.curve(iteration, values, region_colour(result, unknown[u]), true);
        names += (u ? ", " : "") + region_name(result, unknown[u]);
    }
    return figure(plot.svg("Moduli over the iterations"),
                  "Estimate at each iteration: " + names + ".");
}

}  // namespace

std::string interval_figure(const RecoveryResult& result) {
    std::vector<IntervalBar> bars;
    for (const RegionResult& r : result.regions) {
        if (!shown_in_intervals(r)) continue;
        const double told = is_known(r) ? r.stiffness_kpa : NAN;
        IntervalBar bar{r.name, told, {}, region_colour(result, r.region), !r.unknown};
        if (has_interval(r)) bar.interval = {r.interval_kpa[0], r.interval_kpa[1]};
        bars.push_back(std::move(bar));
    }
    if (bars.empty()) return "";
    return figure(
        interval_chart(bars, "Young's modulus E, kPa", "Moduli with their 95 % intervals"),
        "Dots: estimates with 95 % interval, which has no dot where nothing can be told. Diamonds: "
        "given values.");
}

std::string profile_figures(const RecoveryResult& result) {
    std::string out;
    for (const ProfileResult& p : result.profiles) out += profile_figure(result, p);
    return out;
}

std::string convergence_figures(const RecoveryResult& result) {
    if (result.convergence.empty()) return "";
    return objective_figure(result.convergence) + moduli_figure(result);
}

}  // namespace palpate
