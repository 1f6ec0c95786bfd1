// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// Sets up the PoCL driver, by environment variables that the user has not set already:
/// - POCL_CACHE_DIR: a kernel cache folder of this process alone, in memory where that is possible,
///   removed at exit. Before version 6
///   PoCL fails when processes share one, and dies of a damaged entry.
/// - POCL_WORK_GROUP_SPECIALIZATION=0: otherwise PoCL compiles every kernel again at its first
///   launch, in each process, because stored program binaries hold the general version only. Our
///   kernels fix their work-group size, so that the general version is as fast (measured).
/// Must run before the first OpenCL call; further calls do nothing.
void prepare_pocl_environment();

}  // namespace palpate
