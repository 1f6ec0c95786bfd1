// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Number `number` (from 1) of `count` parts of the work.
struct Shard {
    std::size_t number = 1, count = 1;
};

/// Which patients belong to which shard: the longest first, each to the shard that has least so far
/// (Graham 1969). The same for everybody who asks with the same estimates.
///   estimates_s   [patients]
///   returns       [count] positions, in the order in which they should run
std::vector<std::vector<std::size_t>> balanced_shards(const std::vector<double>& estimates_s,
                                                      std::size_t count);

/// "3/50", or "auto": the number and count that an array job of Slurm, Grid Engine, LSF, PBS, AWS
/// Batch or Kubernetes has in its environment. `variable` gives a variable of it, or null.
/// Throws Error(invalid_argument) if it is neither, or if "auto" finds none.
Shard shard_of(const std::string& text, const std::function<const char*(const char*)>& variable);

}  // namespace palpate
