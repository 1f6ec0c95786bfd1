// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate {

struct PlotAxis {
    double low = 0, high = 1;
    bool logarithmic = false;
    std::string label;  ///< with unit
};

/// Round values inside the axis where ticks belong: 1, 2, 5 times powers of ten.
std::vector<double> tick_values(const PlotAxis& axis);

/// A small line plot as inline SVG. Colours come from the style sheet of the page (classes `axis`,
/// `grid`, `curve`, `mark`, `band`, `rule`), so that it follows light, dark and print.
class Plot {
public:
    Plot(std::string id, double width, double height, PlotAxis x, PlotAxis y);

    /// Points that are not finite (or not positive on a log axis) break the line.
    void curve(const std::vector<double>& x, const std::vector<double>& y,
               const std::string& colour, bool with_marks);
    /// Marks without a line; `hollow` ones have the colour as outline.
    void points(const std::vector<double>& x, const std::vector<double>& y,
                const std::string& colour, bool hollow);
    /// Error bars from `low` to `high` at each x; what lies outside the axis is cut off.
    void bars(const std::vector<double>& x, const std::vector<double>& low,
              const std::vector<double>& high, const std::string& colour);
    /// A dashed line through points, such as that of equality; `text` stands at its last point.
    void guide(const std::vector<double>& x, const std::vector<double>& y, const std::string& text);
    void band(double x_low, double x_high, const std::string& colour);
    void horizontal_rule(double y, const std::string& text);
    void vertical_rule(double x, const std::string& text, const std::string& colour);

    /// `title` is the text that screen readers say.
    std::string svg(const std::string& title) const;

private:
    double x_of(double value) const;
    double y_of(double value) const;
    std::string axes() const;

    std::string id_;
    double width_, height_;
    PlotAxis x_, y_;
    std::string under_, over_, labels_;  ///< bands, curves, texts
};

}  // namespace palpate
