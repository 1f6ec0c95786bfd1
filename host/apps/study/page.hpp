// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/apps/study/run_study.hpp"

namespace palpate {

/// study.html: one file that needs nothing else and fetches nothing, without scripts. `report` is
/// that of the rows of `run`. Every text from outside is escaped.
std::string study_page(const Study& study, const StudyRun& run, const StudyReport& report);

/// A picture of the page as a file of its own, with the style sheet inside.
std::string standalone_svg(const std::string& svg);

}  // namespace palpate
