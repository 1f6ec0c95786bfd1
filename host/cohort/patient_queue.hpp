// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/cohort/cohort_plan.hpp"

namespace palpate {

/// What the next process of a patient does.
struct NextWork {
    std::vector<std::string> cases;
    bool on_reference_backend = false;
    double limit_factor = 1;  ///< how much longer than usual it may take
};

/// A case that is over without a result.
struct FinalFailure {
    std::string case_id;
    int code = 1;
    int attempts = 1;
    std::string sentence;
};

/// The cases of one patient that are still to be done, and how often each was tried: first all
/// together, then each that crashed alone, the last time on the reference back end. Bad input
/// (codes 2 to 6) is final at once. What took too long (code 9) is tried once more, with twice the
/// time: a slow machine looks like a process that hangs.
class PatientQueue {
public:
    PatientQueue(std::vector<std::string> waiting, int most_attempts);

    bool is_empty() const { return attempts_.empty(); }
    NextWork next() const;

    void done(const std::string& case_id);
    /// Of a case, or of the patient as a whole (empty id: the reference, or nobody knows which).
    /// Returns those that are over with it.
    std::vector<FinalFailure> failed(const std::string& case_id, int code,
                                     const std::string& sentence);

private:
    std::vector<std::string> order_;
    std::map<std::string, int> attempts_;  ///< of those that are neither done nor over
    std::set<std::string> late_;           ///< those of them that took too long once
    int of_all_ = 0;                       ///< attempts that ended before any case
    bool is_all_late_ = false;
    int most_attempts_;
};

}  // namespace palpate
