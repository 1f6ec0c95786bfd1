// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/recover/report/targets_report.hpp"
#include "host/page/result_tree.hpp"

namespace palpate {

/// What targets.csv tells, for C and Python: a part for each target, and one of all together.
ResultTree targets_tree(const std::vector<TargetRow>& rows);

}  // namespace palpate
