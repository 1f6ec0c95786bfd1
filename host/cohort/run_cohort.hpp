// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/cohort/shards.hpp"
#include "solver/base/log.hpp"

namespace palpate {

struct CohortRunOptions {
    std::filesystem::path folder;
    std::filesystem::path program;  ///< palpate itself
    Shard shard;
    int jobs = 1;                        ///< patients at a time
    std::vector<std::string> only = {};  ///< participants; none: all
    bool retry_failed = false;           ///< cases with a failure file, too
    bool keep_going = false;             ///< though cases fail alike (SharedFailure)
    /// Gets a line of JSON for every case that ends; may be empty.
    std::function<void(const std::string& line)> tell_case;
};

struct CohortRun {
    std::size_t num_cases = 0;  ///< of the shard
    std::size_t done = 0, not_converged = 0, failed = 0;
    std::size_t started_here = 0;  ///< processes
    int exit_code = 0;             ///< 0 or `exit_code_not_converged`
};

/// Runs what is missing of a shard, a process for each patient. Safe to be ended in any way and
/// started again, also by several at a time. Returns when nothing of the shard waits any more, done
/// here or elsewhere. Throws Error(invalid_argument) for a participant that the plan has not,
/// Error(cancelled) at a signal or when cases fail alike (SharedFailure), Error(output_failed) when
/// the disk is full, Error(device_failed) when three patients in a row found no device, or when the
/// tiny phantom fails as a case did (MachineTrial); what was in work then stays waiting. To be
/// called from the main thread.
CohortRun run_cohort(const CohortRunOptions& options, const ProgressSink& progress);

}  // namespace palpate
