// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/engine_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/cohort/cohort_plan.hpp"

namespace palpate {
namespace {

constexpr std::size_t largest_array = 1000;  // MaxArraySize is 1001 unless a site says otherwise

}  // namespace

std::size_t wanted_shards(const CohortPlan& plan) {
    double seconds = 0;
    for (const CohortPatient& patient : plan.patients) seconds += patient.estimate_s;
    const auto wanted = static_cast<std::size_t>(std::ceil(seconds / (60 * plan.shard_minutes)));
    const std::size_t most =
        std::min(largest_array, std::max<std::size_t>(plan.patients.size(), 1));
    return std::clamp<std::size_t>(wanted, 1, most);
}

void write_engine_files(const CohortPlan& plan, const std::filesystem::path& folder) {
    constexpr double runner_mb = 100;  // beside a patient's process
    const std::size_t shards = wanted_shards(plan);
    const int minutes = std::max(10, static_cast<int>(std::ceil(4 * plan.shard_minutes)));
    std::string lines;
    for (const std::string& line : plan.slurm_lines) lines += "#SBATCH " + line + "\n";
    replace_text(folder / "slurm.sh",
                 fmt::format("#!/bin/bash\n"
                             "# Start it in the cohort's folder: sbatch engines/slurm.sh\n"
                             "# Again after anything went wrong: what is done is not done again.\n"
                             "# What depends on it waits with afterany, never with afterok: a case "
                             "that failed is a result.\n"
                             "#SBATCH --job-name=palpate-cohort\n"
                             "#SBATCH --array=1-{0}\n"
                             "#SBATCH --cpus-per-task=1\n"
                             "#SBATCH --mem={3:.0f}M\n"
                             "#SBATCH --time={1}\n"
                             "#SBATCH --signal=B:TERM@60\n"
                             "#SBATCH --requeue\n"
                             "#SBATCH --open-mode=append\n"
                             "#SBATCH --output=logs/slurm-%A_%a.txt\n"
                             "{2}exec palpate cohort run . --shard \"$SLURM_ARRAY_TASK_ID/{0}\" "
                             "--jobs \"${{SLURM_CPUS_PER_TASK:-1}}\" --progress none\n",
                             shards, minutes, lines, plan.limits.memory_mb + runner_mb));
}

}  // namespace palpate
