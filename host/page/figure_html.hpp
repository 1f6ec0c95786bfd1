// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/page/result_tree.hpp"

namespace palpate {

/// One estimate as a card; without value where it is not identifiable. `note_html` stands under
/// the interval.
std::string estimate_card(const Figure& figure, const std::string& heading_html,
                          std::string_view colour, std::string_view note_html = "");
/// The words of a verdict as a coloured label; other words as a plain one.
std::string verdict_chip(const std::string& words);
/// Names and values in two columns, escaped; those without value are left out.
std::string facts_html(const std::vector<std::pair<std::string, std::string>>& rows);

}  // namespace palpate
