// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#if defined(__GLIBC__) || defined(__gnu_linux__)
#include <malloc.h>
#endif

namespace palpate {

/// For programs to call first. The search makes and drops matrices of a hundred megabytes all the
/// time, and so does the set-up of solvers. Kept by the allocator, their pages need not be fetched
/// from the system, and cleared, at every step. Does nothing with another C library than GNU's.
inline void keep_large_blocks() {
#if defined(__GLIBC__)
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, 2047 << 20);
#endif
}

}  // namespace palpate
