#!/bin/bash
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
# A planned cohort as an array job of Slurm, and its tables when the array has ended. The plan writes engines/slurm.sh;
# lines for your site go into [slurm] lines of cohort.toml.
#   slurm.sh COHORT
set -euo pipefail
cd "$1"
job=$(sbatch --parsable engines/slurm.sh)
# afterany: a case that failed is a result, and Slurm's own opinion of a task is not the truth.
sbatch --dependency="afterany:$job" --time=30 --output=logs/collect.txt --wrap "palpate cohort collect ."
