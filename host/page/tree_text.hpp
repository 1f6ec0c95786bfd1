// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/page/result_tree.hpp"

namespace palpate {

/// What of the tree has a title, for a terminal: its figures in lines, then each part under its
/// title, a list as a table. Control characters are replaced.
std::string tree_text(const ResultTree& tree);

}  // namespace palpate
