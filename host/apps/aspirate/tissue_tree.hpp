// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/identify/identified_tree.hpp"

namespace palpate {

/// The tissue's numbers as people call them: Young's modulus of small and slow strains,
///     E = 6 mu (Veronda and Westmann, neo-Hookean) or 6 C1 (reduced polynomial), nearly
/// incompressible, how it stiffens, and how it relaxes, each with its interval and verdict.
ResultTree tissue_tree(const IdentifiedExperiment& found);

/// "mu 0.7 kPa, gamma 12, C 0.4, tau 3 s", as formulas have them.
std::string tissue_sentence(const IdentifiedExperiment& found);

}  // namespace palpate
