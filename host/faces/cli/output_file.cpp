// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/cli/output_file.hpp"

#include <fmt/format.h>

#include "host/system/interrupt.hpp"
#include "solver/base/error.hpp"

namespace palpate {

void check_output_file(const std::filesystem::path& path, bool overwrite) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) {
        throw Error(ErrorCode::output_failed,
                    fmt::format("{} is a folder; give a file with --out", path.string()));
    }
    if (!overwrite && std::filesystem::exists(path, error)) {
        throw Error(ErrorCode::output_failed,
                    fmt::format("{} exists already; choose another --out, or add --overwrite",
                                path.string()));
    }
    will_write(path);
}

}  // namespace palpate
