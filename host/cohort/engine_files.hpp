// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>

namespace palpate {

struct CohortPlan;

/// Shards of the length that the plan wants; at least one, at most one a patient.
std::size_t wanted_shards(const CohortPlan& plan);

/// Writes slurm.sh into `folder`: an array job, a task for each shard.
void write_engine_files(const CohortPlan& plan, const std::filesystem::path& folder);

}  // namespace palpate
