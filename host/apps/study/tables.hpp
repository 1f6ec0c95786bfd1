// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "host/apps/study/accuracy.hpp"
#include "host/apps/study/study.hpp"

namespace palpate {

/// A table of texts as HTML, escaped; columns after the first are aligned right.
struct StudyTable {
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> lines;
    /// Titles over the columns after the first, with how many each spans; may be empty.
    std::vector<std::pair<std::string, std::size_t>> groups{};

    std::string html(const std::string& css_class = "narrow") const;
    std::string plain() const;  ///< for a terminal, columns aligned
};

/// Count, median and mean error and the share of intervals that hold the truth, by group of
/// stiffness; published values (may be empty) beside ours.
StudyTable accuracy_table(const std::vector<Accuracy>& ours,
                          const std::vector<Accuracy>& published);

/// "57 of 60 (95 %; 86 to 99 %)"; "–" without intervals.
std::string holding_text(const Accuracy& accuracy);

std::string signed_percent(double value);  ///< "+3.1 %"
std::string percent(double value);         ///< "3.1 %"

/// What the errors of most studies are made of, for a caption.
std::string other_mesh_note();

/// Sections that most studies share: pictures with `accuracy_table`. `note`: what the errors are
/// made of.
StudySection accuracy_section(const std::vector<Estimate>& ours,
                              const std::vector<Estimate>& published, const std::string& x_label,
                              const std::string& note = other_mesh_note());

}  // namespace palpate
