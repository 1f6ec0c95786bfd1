// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

namespace palpate {

/// What the exit codes of palpate mean (solver/base/error.hpp), for help and descriptors.
inline const std::vector<std::pair<int, const char*>>& exit_codes() {
    static const std::vector<std::pair<int, const char*>> codes = {
        {0, "ok"},
        {1, "internal"},
        {2, "usage"},
        {3, "unreadable input"},
        {4, "unusable input"},
        {5, "meshing"},
        {6, "forward solve"},
        {7, "not converged (result written)"},
        {8, "device"},
        {9, "time limit or cancelled"},
        {10, "output"},
    };
    return codes;
}

}  // namespace palpate
