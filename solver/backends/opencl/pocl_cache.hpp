// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// Gives this process its own kernel cache folder for the PoCL driver, removed at exit: PoCL before
/// version 6 fails when processes share one, and dies of a damaged entry. Does nothing if the user
/// has set POCL_CACHE_DIR. Must run before the first OpenCL call; further calls do nothing.
void use_private_pocl_cache();

}  // namespace palpate
