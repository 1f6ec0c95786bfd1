// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "host/apps/identify/identified_tree.hpp"
#include "host/page/legend.hpp"
#include "host/page/markup.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr double plot_width = 560, plot_height = 300;
constexpr std::size_t most_curves = 6;
constexpr Eigen::Index most_bars = 80;  ///< more would hide the marks

/// Rows that are drawn as one curve.
struct Series {
    std::string name;
    std::vector<double> x, measured, low, high, predicted;
};

bool has_both(const DataBlock& block) {
    return block.time_s.size() > 0 && block.position_mm.size() > 0;
}

double x_of(const DataBlock& block, Eigen::Index row) {
    if (block.position_mm.size() > 0) return block.position_mm(row, 0);
    return block.time_s.size() > 0 ? block.time_s[row] : double(row + 1);
}

std::string x_label(const DataBlock& block) {
    if (block.kind == "stress-stretch" && block.time_s.size() == 0) return "stretch";
    if (block.kind == "profile") return "distance from the axis, mm";
    if (block.position_mm.size() > 0) return "x, mm";
    return block.time_s.size() > 0 ? "time, s" : "row";
}

std::string y_label(const DataBlock& block) {
    return fmt::format("{}, {}", block.kind == "profile" ? "height" : block.kind, block.unit);
}

/// By time where rows have a place as well, a few of the times.
std::vector<Series> series_of(const DataBlock& block) {
    std::map<double, std::vector<Eigen::Index>> groups;
    for (Eigen::Index row = 0; row < block.num_row(); ++row)
        groups[has_both(block) ? block.time_s[row] : 0].push_back(row);
    std::vector<Series> list;
    const std::size_t stride = (groups.size() + most_curves - 1) / most_curves;
    std::size_t number = 0;
    for (auto& [time, rows] : groups) {
        if (number++ % stride != 0 && number != groups.size()) continue;
        std::sort(rows.begin(), rows.end(),
                  [&](Eigen::Index a, Eigen::Index b) { return x_of(block, a) < x_of(block, b); });
        Series one;
        one.name = has_both(block) ? fmt::format("{:.3g} s", time) : block.name;
        for (const Eigen::Index row : rows) {
            one.x.push_back(x_of(block, row));
            one.measured.push_back(block.measured[row]);
            one.low.push_back(block.measured[row] - 1.96 * block.sd[row]);
            one.high.push_back(block.measured[row] + 1.96 * block.sd[row]);
            one.predicted.push_back(block.predicted[row]);
        }
        list.push_back(std::move(one));
    }
    return list;
}

PlotAxis axis_over(const std::vector<Series>& list,
                   std::initializer_list<std::vector<double> Series::*> values,
                   const std::string& label) {
    double low = 1e300, high = -1e300;
    for (const Series& one : list)
        for (const auto member : values)
            for (const double value : one.*member) {
                low = std::min(low, value);
                high = std::max(high, value);
            }
    const double room = high > low ? 0.05 * (high - low) : 1;
    return {low - room, high + room, false, label};
}

Picture picture_of(const DataBlock& block, std::size_t number, bool is_plan) {
    const std::vector<Series> list = series_of(block);
    Plot plot(fmt::format("fit{}", number), plot_width, plot_height,
              axis_over(list, {&Series::x}, x_label(block)),
              axis_over(list, {&Series::measured, &Series::predicted}, y_label(block)));
    std::vector<LegendEntry> legend;
    for (std::size_t k = 0; k < list.size(); ++k) {
        const Series& one = list[k];
        if (Eigen::Index(one.x.size()) <= most_bars)
            plot.bars(one.x, one.low, one.high, list_colour(k));
        plot.points(one.x, one.measured, list_colour(k), true);
        plot.curve(one.x, one.predicted, list_colour(k), false);
        if (list.size() > 1) legend.push_back({one.name, list_colour(k)});
    }
    return {legend_html(legend) + plot.svg(block.name + ": measured and fitted"),
            fmt::format("{}: circles {} (bars: 95 % of the noise), lines are the model.",
                        block.name, is_plan ? "would be measured" : "were measured")};
}

}  // namespace

std::vector<Picture> identified_pictures(const IdentifiedExperiment& found) {
    std::vector<Picture> pictures;
    for (const DataBlock& block : found.fit.prediction->blocks)
        pictures.push_back(picture_of(block, pictures.size(), found.is_plan));
    return pictures;
}

}  // namespace palpate
