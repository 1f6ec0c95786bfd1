// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/recover/report/targets_report.hpp"

namespace palpate {

/// A page without scripts: what each target tells and what all tell together, as a chart for each
/// unknown modulus and a table that links to the report of each target (`<name>/report.html`).
std::string targets_page(const std::vector<TargetRow>& rows, const std::string& version);

}  // namespace palpate
