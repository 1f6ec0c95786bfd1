// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/shared_failure.hpp"

#include "solver/base/error.hpp"

namespace palpate {

void SharedFailure::add_failure(const std::string& patient, int code, const std::string& sentence) {
    if (count_ == 0) {
        code_ = code;
        first_ = sentence;
    }
    if (code != code_ || code == exit_code_of(ErrorCode::time_limit)) is_ruled_out_ = true;
    patients_.insert(patient);
    ++count_;
}

std::optional<std::string> SharedFailure::sentence() const {
    if (is_ruled_out_ || count_ < enough || int(patients_.size()) < enough_patients)
        return std::nullopt;
    return first_;
}

}  // namespace palpate
