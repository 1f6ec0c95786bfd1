// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/page/markup.hpp"

namespace palpate {
namespace {

constexpr double left = 58, right = 14, top = 20, bottom = 44;

double fraction_of(const PlotAxis& axis, double value) {
    if (axis.logarithmic) return std::log(value / axis.low) / std::log(axis.high / axis.low);
    return (value - axis.low) / (axis.high - axis.low);
}

bool drawable(const PlotAxis& axis, double value) {
    return std::isfinite(value) && (!axis.logarithmic || value > 0);
}

std::vector<double> log_ticks(const PlotAxis& axis) {
    const double decades = std::log10(axis.high / axis.low);
    const std::vector<double> steps = decades > 2.5 ? std::vector<double>{1}
                                      : decades > 0.9
                                          ? std::vector<double>{1, 2, 5}
                                          : std::vector<double>{1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8};
    const double stride = decades > 7 ? std::ceil(decades / 6) : 1;
    std::vector<double> ticks;
    for (double e = std::floor(std::log10(axis.low)); e <= std::log10(axis.high); e += stride)
        for (double s : steps) {
            const double value = s * std::pow(10, e);
            if (value >= axis.low * (1 - 1e-9) && value <= axis.high * (1 + 1e-9))
                ticks.push_back(value);
        }
    return ticks;
}

std::vector<double> linear_ticks(const PlotAxis& axis) {
    const double raw = (axis.high - axis.low) / 5;
    const double power = std::pow(10, std::floor(std::log10(raw)));
    double step = 10 * power;
    for (double s : {1.0, 2.0, 5.0})
        if (s * power >= raw * 0.999) {
            step = s * power;
            break;
        }
    std::vector<double> ticks;
    for (double v = std::ceil(axis.low / step - 1e-9) * step; v <= axis.high + 1e-9 * step;
         v += step)
        ticks.push_back(std::abs(v) < 1e-9 * step ? 0 : v);
    return ticks;
}

std::string tick_text(double value) {
    if (value != 0 && (std::abs(value) < 1e-3 || std::abs(value) >= 1e5))
        return fmt::format("{:.0e}", value);
    return fmt::format("{:.6g}", value);
}

}  // namespace

std::vector<double> tick_values(const PlotAxis& axis) {
    return axis.logarithmic ? log_ticks(axis) : linear_ticks(axis);
}

Plot::Plot(std::string id, double width, double height, PlotAxis x, PlotAxis y)
    : id_(std::move(id)), width_(width), height_(height), x_(std::move(x)), y_(std::move(y)) {}

double Plot::x_of(double value) const {
    return left + (width_ - left - right) * fraction_of(x_, value);
}

double Plot::y_of(double value) const {
    return height_ - bottom - (height_ - top - bottom) * fraction_of(y_, value);
}

void Plot::curve(const std::vector<double>& x, const std::vector<double>& y,
                 const std::string& colour, bool with_marks) {
    std::string path, marks;
    bool pen_down = false;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
        const bool good = drawable(x_, x[i]) && drawable(y_, y[i]);
        if (good) {
            path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", x_of(x[i]), y_of(y[i]));
            marks += fmt::format(
                "<circle class='mark' cx='{:.1f}' cy='{:.1f}' r='2.6' "
                "style='fill:{}'/>",
                x_of(x[i]), y_of(y[i]), colour);
        }
        pen_down = good;
    }
    if (!path.empty())
        over_ += fmt::format("<path class='curve' d='{}' style='stroke:{}'/>", path, colour);
    if (with_marks) over_ += marks;
}

void Plot::points(const std::vector<double>& x, const std::vector<double>& y,
                  const std::string& colour, bool hollow) {
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
        if (!drawable(x_, x[i]) || !drawable(y_, y[i])) continue;
        over_ += fmt::format("<circle class='{}' cx='{:.1f}' cy='{:.1f}' r='{}' style='{}:{}'/>",
                             hollow ? "ring" : "mark", x_of(x[i]), y_of(y[i]), hollow ? 4.5 : 4.2,
                             hollow ? "stroke" : "fill", colour);
    }
}

void Plot::bars(const std::vector<double>& x, const std::vector<double>& low,
                const std::vector<double>& high, const std::string& colour) {
    for (std::size_t i = 0; i < std::min({x.size(), low.size(), high.size()}); ++i) {
        if (!drawable(x_, x[i]) || !drawable(y_, low[i]) || !drawable(y_, high[i])) continue;
        over_ += fmt::format(
            "<path class='bar' d='M{0:.1f} {1:.1f}V{2:.1f}M{3:.1f} {1:.1f}h6M{3:.1f} {2:.1f}h6' "
            "style='stroke:{4}'/>",
            x_of(x[i]), y_of(low[i]), y_of(high[i]), x_of(x[i]) - 3, colour);
    }
}

void Plot::guide(const std::vector<double>& x, const std::vector<double>& y,
                 const std::string& text) {
    std::string path;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
        if (!drawable(x_, x[i]) || !drawable(y_, y[i])) continue;
        path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x_of(x[i]), y_of(y[i]));
    }
    if (path.empty()) return;
    under_ += fmt::format("<path class='rule' d='{}'/>", path);
    if (text.empty()) return;
    labels_ += fmt::format("<text class='note' x='{:.1f}' y='{:.1f}' text-anchor='end'>{}</text>",
                           x_of(x.back()) - 6, y_of(y.back()) + 12, escape_html(text));
}

void Plot::band(double x_low, double x_high, const std::string& colour) {
    if (!drawable(x_, x_low) || !drawable(x_, x_high)) return;
    under_ += fmt::format(
        "<rect class='band' x='{:.1f}' y='{}' width='{:.1f}' height='{:.1f}' style='fill:{}'/>",
        x_of(x_low), top, std::max(1.0, x_of(x_high) - x_of(x_low)), height_ - top - bottom,
        colour);
}

void Plot::horizontal_rule(double y, const std::string& text) {
    if (!drawable(y_, y) || y < y_.low || y > y_.high) return;
    over_ += fmt::format("<path class='rule' d='M{} {:.1f}H{}'/>", left, y_of(y), width_ - right);
    // Left of the middle: there a profile leaves room above its minimum.
    labels_ += fmt::format("<text class='note' x='{}' y='{:.1f}' text-anchor='end'>{}</text>",
                           (left + width_ - right) / 2 - 8, y_of(y) - 5, escape_html(text));
}

void Plot::vertical_rule(double x, const std::string& text, const std::string& colour) {
    if (!drawable(x_, x) || x < x_.low || x > x_.high) return;
    over_ += fmt::format("<path class='estimate' d='M{:.1f} {}V{}' style='stroke:{}'/>", x_of(x),
                         top, height_ - bottom, colour);
    labels_ += fmt::format(
        "<text class='note strong' x='{:.1f}' y='{}' text-anchor='middle'>"
        "{}</text>",
        std::clamp(x_of(x), left + 30, width_ - right - 30), top - 7, escape_html(text));
}

std::string Plot::axes() const {
    std::string out;
    for (double v : tick_values(x_))
        out += fmt::format(
            "<path class='grid' d='M{0:.1f} {1}V{2}'/><text class='tick' x='{0:.1f}' "
            "y='{3}' text-anchor='middle'>{4}</text>",
            x_of(v), top, height_ - bottom, height_ - bottom + 15, tick_text(v));
    for (double v : tick_values(y_))
        out += fmt::format(
            "<path class='grid' d='M{0} {1:.1f}H{2}'/><text class='tick' x='{3}' "
            "y='{4:.1f}' text-anchor='end'>{5}</text>",
            left, y_of(v), width_ - right, left - 7, y_of(v) + 3.5, tick_text(v));
    out += fmt::format("<path class='axis' d='M{0} {1}V{2}H{3}'/>", left, top, height_ - bottom,
                       width_ - right);
    out += fmt::format("<text class='label' x='{}' y='{}' text-anchor='middle'>{}</text>",
                       (left + width_ - right) / 2, height_ - 8, escape_html(x_.label));
    const double middle = (top + height_ - bottom) / 2;
    out += fmt::format(
        "<text class='label' x='13' y='{0}' text-anchor='middle' "
        "transform='rotate(-90 13 {0})'>{1}</text>",
        middle, escape_html(y_.label));
    return out;
}

std::string Plot::svg(const std::string& title) const {
    const std::string clip =
        fmt::format("<clipPath id='{}'><rect x='{}' y='{}' width='{}' height='{}'/></clipPath>",
                    id_, left, top, width_ - left - right, height_ - top - bottom);
    return fmt::format(
        "<svg class='plot' viewBox='0 0 {0} {1}' role='img' aria-label='{2}'>{3}"
        "<g clip-path='url(#{4})'>{5}</g>{6}<g clip-path='url(#{4})'>{7}</g>{8}"
        "</svg>",
        width_, height_, escape_html(title), clip, id_, under_, axes(), over_, labels_);
}

}  // namespace palpate
