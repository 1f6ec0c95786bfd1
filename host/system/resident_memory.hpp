// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

namespace palpate {

/// Resident memory of a process and of all that it has started, MB, pages that several share
/// counted once; 0 once it is gone.
double resident_mb(pid_t process);

/// Whether resident_mb is above `mb`. That takes 20 ms for a process of 1 GB, so what costs
/// nothing, shared pages counted for each, is looked at first.
bool holds_more_than(pid_t process, double mb);

}  // namespace palpate
