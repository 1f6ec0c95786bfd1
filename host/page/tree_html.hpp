// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/page/result_tree.hpp"

namespace palpate {

/// What of the tree has a title as HTML with the classes of page.css: its estimates as cards, its
/// other figures in two columns, then each part under its title, a list as a table. Texts are
/// escaped.
std::string tree_html(const ResultTree& tree);

/// The same as sections of a page: its own figures in one, each part in its own. `pictures_html`,
/// sections too, stand after the first: what was found, then what to look at, then the rest.
std::string tree_sections_html(const ResultTree& tree, const std::string& pictures_html = "");

}  // namespace palpate
