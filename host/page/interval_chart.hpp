// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// A line of an interval chart: an estimate with its interval, or a given value.
struct IntervalBar {
    std::string name;
    double value = 0;  ///< positive, or NaN: an interval alone, without a dot
    std::optional<std::pair<double, double>> interval;  ///< positive, lower end first
    std::string colour;                                 ///< as CSS
    bool is_given = false;                              ///< drawn as a diamond
};

/// Bars under each other on one logarithmic axis, as inline SVG that follows the page's style
/// sheet. `axis` says what is drawn, with its unit; `title` is the text that screen readers say.
/// Empty without bars.
std::string interval_chart(const std::vector<IntervalBar>& bars, const std::string& axis,
                           const std::string& title);

}  // namespace palpate
