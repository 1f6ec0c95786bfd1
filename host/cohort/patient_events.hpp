// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "host/cohort/case_record.hpp"

namespace palpate {

/// What the process of a patient tells its runner, a line of JSON each.
struct PatientEvent {
    enum class Kind {
        started,         ///< work on `case_id` begins
        done,            ///< its folder is there
        failed,          ///< `case_id` ended with `code` and `sentence`
        patient_failed,  ///< the reference did: no further case is tried
    };
    Kind kind = Kind::started;
    std::string case_id = {};
    int code = 0;
    std::string sentence = {};
    std::optional<CaseRecord> record = {};  ///< of done
};

/// With its end of line.
std::string event_line(const PatientEvent& event);
/// Empty if the line is none.
std::optional<PatientEvent> event_of(const std::string& line);

}  // namespace palpate
