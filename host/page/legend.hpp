// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate {

/// One kind of mark in a plot.
struct LegendEntry {
    std::string text, colour;
    bool is_hollow = false;
};

/// What stands above a plot that holds several; texts are escaped.
std::string legend_html(const std::vector<LegendEntry>& entries);

}  // namespace palpate
