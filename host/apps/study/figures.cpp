// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/page/markup.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

struct Series {
    std::vector<double> x, y, low, high;

    void add(const Estimate& estimate) {
        x.push_back(estimate.expected_kpa);
        y.push_back(estimate.found_kpa);
        low.push_back(estimate.has_interval() ? estimate.interval_kpa[0] : NAN);
        high.push_back(estimate.has_interval() ? estimate.interval_kpa[1] : NAN);
    }
};

std::vector<double> errors_of(const std::vector<Estimate>& estimates) {
    std::vector<double> errors;
    for (const Estimate& e : estimates) errors.push_back(e.error_percent());
    return errors;
}

std::vector<double> expected_of(const std::vector<Estimate>& estimates) {
    std::vector<double> expected;
    for (const Estimate& e : estimates) expected.push_back(e.expected_kpa);
    return expected;
}

/// A little room round the true values of both.
PlotAxis stiffness_axis(const std::vector<Estimate>& ours, const std::vector<Estimate>& published,
                        const std::string& label) {
    double low = INFINITY, high = 0;
    for (const auto* estimates : {&ours, &published})
        for (const Estimate& e : *estimates) {
            low = std::min(low, e.expected_kpa);
            high = std::max(high, e.expected_kpa);
        }
    if (!(low < high)) {
        low *= 0.6;
        high *= 1.6;
    }
    return {low / 1.25, high * 1.25, true, label};
}

std::vector<LegendEntry> legend_of(const Series& held, const Series& missed,
                                   const std::vector<Estimate>& published) {
    std::vector<LegendEntry> entries;
    if (!held.x.empty()) entries.push_back({"palpate, interval holds the truth", our_colour});
    if (!missed.x.empty()) entries.push_back({"palpate, interval misses it", miss_colour});
    if (!published.empty()) entries.push_back({"published", published_colour, true});
    return entries;
}

}  // namespace

StudyPicture recovered_picture(const std::vector<Estimate>& ours,
                               const std::vector<Estimate>& published, const std::string& x_label) {
    Series held, missed, theirs;
    for (const Estimate& e : ours) (e.has_interval() && !e.holds_truth() ? missed : held).add(e);
    for (const Estimate& e : published) theirs.add(e);
    const PlotAxis x = stiffness_axis(ours, published, x_label);
    PlotAxis y{x.low / 1.2, x.high * 1.2, true, "recovered E, kPa"};
    for (const auto* series : {&held, &missed, &theirs})
        for (const double value : series->y) {
            y.low = std::min(y.low, value / 1.15);
            y.high = std::max(y.high, value * 1.15);
        }
    Plot plot("recovered", 440, 380, x, y);
    plot.guide({x.low, x.high}, {x.low, x.high}, "");
    plot.bars(held.x, held.low, held.high, our_colour);
    plot.bars(missed.x, missed.low, missed.high, miss_colour);
    plot.points(theirs.x, theirs.y, published_colour, true);
    plot.points(held.x, held.y, our_colour, false);
    plot.points(missed.x, missed.y, miss_colour, false);
    return {"recovered", plot.svg("Recovered stiffness over true stiffness"),
            legend_html(legend_of(held, missed, published)),
            "Recovered over true stiffness with 95 % intervals. Dashed: perfect agreement."};
}

StudyPicture error_picture(const std::vector<Estimate>& ours,
                           const std::vector<Estimate>& published, const std::string& x_label) {
    const auto errors = errors_of(ours), theirs = errors_of(published);
    double reach = 20;
    for (const auto* values : {&errors, &theirs})
        for (const double e : *values) reach = std::max(reach, 1.1 * std::abs(e));
    const PlotAxis x = stiffness_axis(ours, published, x_label);
    const double low = std::max(-100.0, -reach);
    Plot plot("error", 440, 380, x, {low, reach, false, "error, %"});
    plot.guide({x.low, x.high}, {0, 0}, "");
    plot.points(expected_of(published), theirs, published_colour, true);
    plot.points(expected_of(ours), errors, our_colour, false);
    std::vector<LegendEntry> legend{{"palpate", our_colour}};
    if (!published.empty()) legend.push_back({"published", published_colour, true});
    return {"error", plot.svg("Error over true stiffness"), legend_html(legend),
            "Error by stiffness. Stiff organs change shape less, so the same noise weighs more."};
}

}  // namespace palpate
