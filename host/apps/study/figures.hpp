// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "host/apps/study/accuracy.hpp"
#include "host/apps/study/study.hpp"
#include "host/page/legend.hpp"

namespace palpate {

/// Colours of the pages: ours, intervals that miss the truth, published values.
constexpr const char* our_colour = "var(--accent)";
constexpr const char* miss_colour = "var(--bad)";
constexpr const char* published_colour = "#d55e00";

/// Recovered over true stiffness with 95 % intervals, both logarithmic, and published values beside
/// them (may be empty).
StudyPicture recovered_picture(const std::vector<Estimate>& ours,
                               const std::vector<Estimate>& published,
                               const std::string& x_label = "true E of the prostate, kPa");

/// Error in percent over true stiffness.
StudyPicture error_picture(const std::vector<Estimate>& ours,
                           const std::vector<Estimate>& published,
                           const std::string& x_label = "true E of the prostate, kPa");

}  // namespace palpate
