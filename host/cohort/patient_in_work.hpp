// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <set>
#include <string>

#include "host/cohort/claim.hpp"
#include "host/cohort/cohort_plan.hpp"
#include "host/cohort/patient_queue.hpp"
#include "host/cohort/supervised_child.hpp"

namespace palpate {

/// A patient in work: its claim, what is left of it, the process of now.
struct PatientInWork {
    using Clock = std::chrono::steady_clock;

    std::unique_ptr<const CohortPatient> patient;
    Claim claim;
    PatientQueue queue;
    std::unique_ptr<SupervisedChild> child = nullptr;
    std::string current = {};  ///< case; empty: the reference
    Clock::time_point last_event = {}, last_look = {}, asked_to_end = {};
    double limit_s = 0;                     ///< of its process, between two events
    std::string passed_limit = {};          ///< in words; empty: none
    std::set<std::string> unreported = {};  ///< cases that its process was asked for
    bool has_device_failure = false;
};

}  // namespace palpate
