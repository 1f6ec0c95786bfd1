// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "host/cohort/claim.hpp"
#include "host/cohort/cohort_plan.hpp"
#include "host/cohort/patient_queue.hpp"
#include "host/cohort/supervised_child.hpp"

namespace palpate {

/// What ended a case, or the patient (empty id: its reference, or nobody knows which).
struct CaseFault {
    std::string case_id;
    int code = 1;
    std::string why;
};

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
    bool passed_memory = false;             ///< the limit that it passed
    std::set<std::string> unreported = {};  ///< cases that its process was asked for
    bool has_device_failure = false;
    bool has_ended = false;              ///< its process
    std::vector<CaseFault> faults = {};  ///< that may be the machine's: nothing follows from them
    std::size_t trial = 0;               ///< of the machine, that they wait for

    /// For a process that is made next.
    void begin_watch(double limit_of_process_s, const std::vector<std::string>& cases);
    /// Ends a process that takes too long, or more memory than this with what it has started.
    void end_beyond_limits(double most_mb);
    /// Of a process that ended although cases are left, and did not say why.
    CaseFault unsaid_fault(const ChildEnd& end) const;
    /// Whether such an end says something of the machine: neither does `kill -9`, nor a limit of
    /// memory.
    bool may_be_of_machine(const ChildEnd& end) const;
    /// What the process wrote to its standard error, at the end of `file`; no error if it cannot.
    void append_log_to(const std::filesystem::path& file) const;
};

}  // namespace palpate
