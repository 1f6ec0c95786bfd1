// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/shared_failure.hpp"

namespace palpate {

void SharedFailure::add_failure(int code, const std::string& sentence) {
    if (count_ == 0) {
        code_ = code;
        first_ = sentence;
    }
    if (code != code_) is_ruled_out_ = true;
    ++count_;
}

std::optional<std::string> SharedFailure::sentence() const {
    if (is_ruled_out_ || count_ < enough) return std::nullopt;
    return first_;
}

}  // namespace palpate
