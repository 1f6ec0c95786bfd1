// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {

/// Throws Error(input_unreadable): the file is not what it should be, or damaged.
[[noreturn]] inline void unreadable_mesh(const std::filesystem::path& path,
                                         const std::string& why) {
    throw Error(ErrorCode::input_unreadable,
                "cannot read the mesh '" + path.string() + "': " + why);
}

/// Throws Error(input_unusable): the file can be read, but what is in it does not serve.
[[noreturn]] inline void unusable_mesh(const std::filesystem::path& path, const std::string& why) {
    throw Error(ErrorCode::input_unusable,
                "the mesh '" + path.string() + "' cannot be used: " + why);
}

}  // namespace palpate
