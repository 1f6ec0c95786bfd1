// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "host/apps/study/row.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// One case of a study: it gives one row, the same whenever it is run.
struct StudyCase {
    std::string id;     ///< unique in the study: "seed-4", "seed-4-e150"
    std::string title;  ///< for the progress line: "seed 4, 83 kPa"
    std::function<Row(const ProgressSink&)> run;
};

struct StudyPicture {
    std::string name;     ///< file name without ending
    std::string svg;      ///< inline SVG, coloured by the style sheet of the page
    std::string legend;   ///< HTML, may be empty
    std::string caption;  ///< plain text
};

struct StudySection {
    std::string title;
    std::string html;  ///< tables and text, after the pictures
    std::vector<StudyPicture> pictures;
};

/// A named number of the summary, for study.json: "all.median_abs_error_percent".
using Fact = std::pair<std::string, double>;

/// What a study says of its rows; made again whenever the page is.
struct StudyReport {
    std::string headline;                ///< the answer in one sentence
    std::vector<std::string> sentences;  ///< plain text, under the headline
    std::vector<StudySection> sections;
    std::vector<Fact> facts;
    std::string text;  ///< the summary as a table for the terminal
};

/// A seeded list of cases and what their rows mean.
struct Study {
    std::string name;   ///< as on the command line
    std::string title;  ///< what is studied, for the head of the page
    std::vector<std::pair<std::string, std::string>> settings;  ///< what rows depend on
    std::vector<std::string> columns;                           ///< of the rows, in order
    std::vector<StudyCase> cases;
    std::function<StudyReport(const std::vector<Row>& rows)> report;  ///< of rows without failure
};

}  // namespace palpate
