// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "solver/base/locked_folder.hpp"

namespace palpate {

/// In memory, of this process: for parsers that take a path.
inline const std::filesystem::path& fuzz_folder() {
    static const LockedFolder folder("/dev/shm", "palpate-fuzz-", LockedFolder::Readers::owner);
    return folder.path();
}

inline std::filesystem::path fuzz_file(const std::string& name, const std::uint8_t* data,
                                       std::size_t size) {
    const std::filesystem::path path = fuzz_folder() / name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path;
}

}  // namespace palpate
