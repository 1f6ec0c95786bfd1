// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "host/io/option_values.hpp"
#include "host/page/result_tree.hpp"
#include "host/system/time_limit.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// A plot of a report.
struct Picture {
    std::string html;     ///< inline SVG, with a legend where it needs one
    std::string caption;  ///< one sentence
};

/// What a run gives back.
struct Outcome {
    ResultTree result;
    /// For a terminal; empty: the figures of the result that have titles.
    std::string text = {};
    /// 0, or of a result that is flagged: `exit_code_not_converged`, or the first failure's among
    /// several cases.
    int exit_code = 0;
    std::vector<Picture> pictures = {};  ///< of the report
    /// More files of the result folder: name and text.
    std::vector<std::pair<std::string, std::string>> files = {};
};

/// What palpate can be used for. From its table of options come its command, its settings as text,
/// its functions in C and Python, its descriptors for other programs and its page of documentation;
/// none of these knows it by name.
struct Application {
    std::string name;     ///< one word, lower case: the command
    std::string summary;  ///< one sentence without a full stop
    std::vector<Option> options;
    /// The values are allowed by the table. Throws Error; the sink may throw to cancel.
    Outcome (*run)(const OptionValues& values, const ProgressSink& progress);

    /// Whether it has an option `out` of its own and writes it itself.
    bool writes_its_folder() const { return find_option(options, "out") != nullptr; }
};

/// Its own options and those that all applications have: `out`, `overwrite` (of those that do not
/// write their folder themselves), `time_limit`.
std::vector<Option> all_options(const Application& application);

/// Runs it within its `time_limit` and, unless it does so itself, writes `result.json` and
/// `report.html` into the folder `out`, if there is one. `values` are of `all_options`. Throws what
/// the run throws, Error(time_limit) and Error(output_failed).
Outcome run_application(const Application& application, const OptionValues& values, LimitEnds ends,
                        const ProgressSink& progress = {});

}  // namespace palpate
