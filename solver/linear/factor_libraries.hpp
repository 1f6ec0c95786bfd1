// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "solver/linear/sparse_factor.hpp"

namespace palpate {

/// "mumps", "cholmod", "eigen": the libraries compiled into this build, in order of preference.
const std::vector<std::string>& sparse_factor_names();

/// `name` empty: the first of the list. Throws Error(unsupported) naming those that there are.
std::unique_ptr<SparseFactor> make_sparse_factor(const std::string& name);

}  // namespace palpate
