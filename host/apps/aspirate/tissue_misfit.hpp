// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/identify/identified_tree.hpp"

namespace palpate {

/// Whether a fit leaves too much of the travel unexplained for anybody to believe it.
bool is_no_model(const Fit& fit, double travel_mm);

/// Why the model is none of the film, in a sentence; empty if it may be one.
std::string misfit_of(const Fit& fit, double travel_mm);

/// For much that is unexplained, for each number of the instrument that came out far from what was
/// told of it, and for a surface at rest that was not found.
std::vector<std::string> warnings_of(const IdentifiedExperiment& found, double travel_mm);

}  // namespace palpate
