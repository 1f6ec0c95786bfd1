#!/bin/bash
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
# A planned cohort on this machine by GNU parallel, a shard after the other on each core; again after it was stopped,
# also with another number of shards. The cohort itself says what is done, so no --resume is needed.
#   parallel.sh COHORT [SHARDS [JOBS]]
set -uo pipefail
cohort=$1 shards=${2:-8} jobs=${3:-$(nproc)}
seq "$shards" | parallel --jobs "$jobs" --joblog "$cohort/logs/parallel.tsv" \
    palpate cohort run "$cohort" --shard "{}/$shards" --progress none
palpate cohort status "$cohort"
