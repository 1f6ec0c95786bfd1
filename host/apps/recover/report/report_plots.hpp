// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/recover/result/recovery_result.hpp"

namespace palpate {

/// The plots of the report as HTML figures with inline SVG; empty text where there is nothing to
/// draw.
std::string interval_figure(const RecoveryResult& result);      ///< all moduli on one log axis
std::string profile_figures(const RecoveryResult& result);      ///< one per unknown modulus
std::string convergence_figures(const RecoveryResult& result);  ///< objective and moduli

}  // namespace palpate
