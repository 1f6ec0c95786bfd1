// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace palpate {

/// Makes one private folder for all temporary files of this program and of those that it starts
/// (TMPDIR points to it from here on), to be removed when the program ends. Removes those that were
/// left behind by programs that were killed. Where none can be made everything stays as it is.
void make_scratch();

/// Removes it now. A program that is still writing into it does not keep it alive.
void remove_scratch();

/// Removes a folder or file, again and again while something appears in it.
void remove_persistently(const std::filesystem::path& path);

}  // namespace palpate
