// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/system/scratch.hpp"

#include <cstdlib>
#include <filesystem>
#include <memory>

#include "solver/base/error.hpp"
#include "solver/base/locked_folder.hpp"

namespace palpate {
namespace {

/// Of this program; none if it could not be made.
std::unique_ptr<LockedFolder>& scratch() {
    static auto* one = new std::unique_ptr<LockedFolder>;  // outlives every exit handler
    return *one;
}

void remove_scratch() { scratch().reset(); }

}  // namespace

void make_scratch() {
    std::error_code failed;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(failed);
    if (failed) return;
    try {
        scratch() = std::make_unique<LockedFolder>(parent, "palpate-scratch-",
                                                   LockedFolder::Readers::owner);
    } catch (const Error&) {
        return;
    }
    setenv("TMPDIR", scratch()->path().c_str(), 1);
    std::atexit(remove_scratch);
    std::at_quick_exit(remove_scratch);
}

}  // namespace palpate
