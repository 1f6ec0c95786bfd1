// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace palpate {

/// Finds `palpate-mesh`: `given` if not empty, the environment variable PALPATE_MESH, beside the
/// running program, ../libexec/palpate and ../libexec from there, then PATH. Throws
/// Error(mesh_failed) saying how to get it.
std::filesystem::path find_mesh_program(const std::filesystem::path& given);

}  // namespace palpate
