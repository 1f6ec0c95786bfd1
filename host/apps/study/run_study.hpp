// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/apps/study/study.hpp"

namespace palpate {

struct StudyRunOptions {
    std::filesystem::path folder;
    bool overwrite = false;              ///< begin again in a folder that holds a study
    int jobs = 1;                        ///< cases that run at the same time
    std::function<bool()> is_cancelled;  ///< asked often; when true, the study stops early
};

struct StudyRun {
    std::vector<Row> rows;  ///< that are done, in the order of the cases
    std::vector<std::pair<std::string, std::string>> failures;  ///< case id, message
    std::size_t num_cases = 0;
    std::size_t num_resumed = 0;  ///< rows that were there already
    bool is_cancelled = false;
    std::exception_ptr stopped_by;  ///< what the progress sink threw to stop it, if it did
};

/// Runs the cases of which `folder` has no row yet. After each, study.csv is replaced in one step,
/// so that it is whole whenever the program stops. A case that throws Error is told in the row's
/// place (`failures`) and tried again by the next run.
/// What the progress sink throws stops the study early and is kept (`stopped_by`).
/// Throws Error(output_failed) if the folder cannot be written or holds something else: another
/// study, other settings (both are named), or no study.
StudyRun run_study(const Study& study, const StudyRunOptions& options,
                   const ProgressSink& progress = {});

/// Writes study.html, study.json and pictures/*.svg for these rows, each in one step.
void write_study_page(const Study& study, const StudyRun& run, const std::filesystem::path& folder);

}  // namespace palpate
