// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/page/result_tree.hpp"

namespace palpate {

/// The tree as JSON in its order, indented by two, with a line end. Numbers that are not finite
/// are null, and what is not UTF-8 is replaced.
std::string tree_json(const ResultTree& tree);

}  // namespace palpate
