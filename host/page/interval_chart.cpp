// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/interval_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/page/markup.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr double width = 900, names_width = 190, row_height = 30, room = 1.35;

PlotAxis axis_over(const std::vector<IntervalBar>& bars, const std::string& label) {
    double low = INFINITY, high = 0;
    for (const IntervalBar& bar : bars) {
        low = std::min({low, bar.value, bar.interval ? bar.interval->first : bar.value});
        high = std::max({high, bar.value, bar.interval ? bar.interval->second : bar.value});
    }
    return {low / room, high * room, true, label};
}

std::string bar_svg(const IntervalBar& bar, double y, const std::function<double(double)>& x_of) {
    std::string out =
        fmt::format("<text class='name' x='0' y='{:.1f}'>{}</text>", y + 4, escape_html(bar.name));
    if (bar.interval)
        out += fmt::format(
            "<path class='whisker' style='stroke:{0}' d='M{1:.1f} {2:.1f}H{3:.1f}"
            "M{1:.1f} {4:.1f}v10M{3:.1f} {4:.1f}v10'/>",
            bar.colour, x_of(bar.interval->first), y, x_of(bar.interval->second), y - 5);
    if (!std::isfinite(bar.value)) return out;
    const double x = x_of(bar.value);
    if (bar.is_given)
        return out +
               fmt::format("<path class='given' d='M{:.1f} {:.1f}l5.5 5.5 -5.5 5.5 -5.5 -5.5z'/>",
                           x, y - 5.5);
    return out + fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='5.5' style='fill:{}'/>", x, y,
                             bar.colour);
}

}  // namespace

std::string interval_chart(const std::vector<IntervalBar>& bars, const std::string& label,
                           const std::string& title) {
    if (bars.empty()) return "";
    const PlotAxis axis = axis_over(bars, label);
    const double rows_height = row_height * double(bars.size()), height = rows_height + 44;
    const auto x_of = [&](double value) {
        return names_width + (width - names_width - 20) * std::log(value / axis.low) /
                                 std::log(axis.high / axis.low);
    };
    std::string out;
    for (double v : tick_values(axis))
        out += fmt::format(
            "<path class='grid' d='M{0:.1f} 2V{1}'/><text class='tick' x='{0:.1f}' "
            "y='{2}' text-anchor='middle'>{3:.6g}</text>",
            x_of(v), rows_height + 4, rows_height + 18, v);
    double y = row_height / 2 + 2;
    for (const IntervalBar& bar : bars) {
        out += bar_svg(bar, y, x_of);
        y += row_height;
    }
    out += fmt::format("<text class='label' x='{}' y='{}' text-anchor='middle'>{}</text>",
                       (names_width + width) / 2, height - 6, escape_html(axis.label));
    return fmt::format(
        "<svg class='plot wide' viewBox='0 0 {} {}' role='img' aria-label='{}'>{}</svg>", width,
        height, escape_html(title), out);
}

}  // namespace palpate
