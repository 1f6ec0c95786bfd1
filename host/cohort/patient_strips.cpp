// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/patient_strips.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/cohort/plain_statistics.hpp"
#include "host/page/markup.hpp"
#include "host/page/numbers.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr double width = 1000, names_width = 150, counts_width = 110;
constexpr double room = 1.12, row_gap = 14, line_height = 5, least_row = 26;
constexpr double tail = 0.01;  // of the intervals' ends beyond the axis, on each side
constexpr double top_margin = 22;
constexpr double tall = 300;  // gets ticks at its top, too
constexpr int num_bins = 40;
constexpr double bins_height = 110;

/// Where a modulus lies across the picture; what is beyond the axis lies at its end.
struct Across {
    const StripAxis& axis;
    double left, right;
    double operator()(double kpa) const {
        const double share = std::log(kpa / axis.low) / std::log(axis.high / axis.low);
        return left + (right - left) * std::clamp(share, 0.0, 1.0);
    }
};

std::string grid_svg(const StripAxis& axis, const Across& x, double height) {
    std::string out;
    for (const double v : tick_values({axis.low, axis.high, true, ""}))
        out += fmt::format(
            "<path class='grid' d='M{0:.1f} {4:.1f}V{1:.1f}'/><text class='tick' x='{0:.1f}' "
            "y='{2:.1f}' "
            "text-anchor='middle'>{3:.6g}</text>",
            x(v), height + 4, height + 18, v, top_margin - 4);
    if (height > tall)
        for (const double v : tick_values({axis.low, axis.high, true, ""}))
            out += fmt::format(
                "<text class='tick' x='{:.1f}' y='12' text-anchor='middle'>{:.6g}</text>", x(v), v);
    return out + fmt::format(
                     "<text class='label' x='{:.1f}' y='{:.1f}' text-anchor='middle'>"
                     "Young's modulus E, kPa</text>",
                     (x.left + x.right) / 2, height + 36);
}

double median_of(const PatientStrip& strip) {
    std::vector<double> kpa;
    for (const StripPoint& point : strip.points) kpa.push_back(point.e);
    return plain_statistics(std::move(kpa)).median;
}

double row_height(const PatientStrip& strip) {
    return std::max(least_row, row_gap + line_height * double(strip.points.size()));
}

std::string point_svg(const StripPoint& point, const Across& x, double y,
                      const std::string& target) {
    const char* colour = point.is_weak ? "var(--weak)" : "var(--accent)";
    std::string mark = fmt::format(
        "<path d='M{:.1f} {:.1f}H{:.1f}' style='stroke:{};stroke-opacity:.45;stroke-width:1.4'/>"
        "<circle cx='{:.1f}' cy='{:.1f}' r='3' style='fill:{}'/>",
        x(point.low), y, x(point.high), colour, x(point.e), y, colour);
    if (point.is_doubtful)
        mark += fmt::format(
            "<circle cx='{:.1f}' cy='{:.1f}' r='5.5' "
            "style='fill:none;stroke:var(--bad);stroke-width:1.3'/>",
            x(point.e), y);
    return fmt::format("<a href='{}'><title>{} kPa ({} to {})</title>{}</a>", escape_html(target),
                       significant(point.e), significant(point.low), significant(point.high), mark);
}

}  // namespace

StripAxis strip_axis(const std::vector<PatientStrip>& strips) {
    std::vector<float> lows, highs;
    double least = HUGE_VAL, most = 0;
    for (const PatientStrip& strip : strips)
        for (const StripPoint& point : strip.points) {
            lows.push_back(point.low);
            highs.push_back(point.high);
            least = std::min(least, double(point.e));
            most = std::max(most, double(point.e));
        }
    if (lows.empty()) return {};
    const auto skipped = static_cast<std::ptrdiff_t>(tail * double(lows.size()));
    std::nth_element(lows.begin(), lows.begin() + skipped, lows.end());
    std::nth_element(highs.begin(), highs.end() - 1 - skipped, highs.end());
    return {std::min(least, double(lows[std::size_t(skipped)])) / room,
            std::max(most, double(*(highs.end() - 1 - skipped))) * room};
}

std::string strips_svg(std::span<const PatientStrip> strips, const StripAxis& axis,
                       const std::function<std::string(std::size_t)>& link) {
    if (!(axis.low > 0) || strips.empty()) return "";
    const Across x{axis, names_width, width - counts_width};
    std::string rows;
    double top = top_margin;
    for (const PatientStrip& strip : strips) {
        const double height = row_height(strip), middle = top + height / 2;
        rows += fmt::format(
            "<path class='grid' d='M0 {0:.1f}H{1}'/><text class='name' x='0' y='{2:.1f}'>{3}</text>"
            "<text x='{1}' y='{2:.1f}' text-anchor='end'>{4} of {5}</text>",
            top + height, width, middle + 4, escape_html(strip.patient), strip.points.size(),
            strip.pairs);
        double y = middle - line_height * (double(strip.points.size()) - 1) / 2;
        if (!strip.points.empty())
            rows += fmt::format(
                "<path d='M{0:.1f} {1:.1f}V{2:.1f}' "
                "style='stroke:var(--ink);stroke-width:2;stroke-opacity:.55'/>",
                x(median_of(strip)), top + 3, top + height - 3);
        for (const StripPoint& point : strip.points) {
            rows += point_svg(point, x, y, link(point.number));
            y += line_height;
        }
        top += height;
    }
    return fmt::format(
        "<svg class='plot wide' viewBox='0 0 {} {:.0f}' role='img' "
        "aria-label='Moduli of all pairs by patient'>{}{}</svg>",
        width, top + 42, grid_svg(axis, x, top), rows);
}

std::string medians_svg(const std::vector<PatientStrip>& strips, const StripAxis& axis,
                        const std::string& region) {
    if (!(axis.low > 0)) return "";
    std::vector<std::size_t> counts(num_bins, 0);
    for (const PatientStrip& strip : strips) {
        if (strip.region != region || strip.points.empty()) continue;
        const double share = std::log(median_of(strip) / axis.low) / std::log(axis.high / axis.low);
        ++counts[std::size_t(std::clamp(int(share * num_bins), 0, num_bins - 1))];
    }
    const std::size_t most = *std::max_element(counts.begin(), counts.end());
    if (most == 0) return "";
    const Across x{axis, names_width, width - counts_width};
    std::string bars;
    const double step = (x.right - x.left) / num_bins;
    for (int k = 0; k < num_bins; ++k) {
        const double height = bins_height * double(counts[std::size_t(k)]) / double(most);
        bars += fmt::format(
            "<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' style='fill:var(--accent);"
            "fill-opacity:.6'><title>{} patients</title></rect>",
            x.left + k * step + 0.5, top_margin + bins_height - height, step - 1, height,
            counts[std::size_t(k)]);
    }
    return fmt::format(
        "<svg class='plot wide' viewBox='0 0 {} {}' role='img' aria-label='Patients "
        "by their median'>{}<text class='name' x='0' y='20'>patients</text><text "
        "x='0' y='36'>highest bar: {}</text>{}</svg>",
        width, top_margin + bins_height + 42, grid_svg(axis, x, top_margin + bins_height), most,
        bars);
}

}  // namespace palpate
