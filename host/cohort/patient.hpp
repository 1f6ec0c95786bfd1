// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/cohort/cohort_plan.hpp"
#include "host/cohort/patient_events.hpp"
#include "host/cohort/plan_file.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// The work of one process of a run: some cases of one patient.
struct PatientJob {
    std::filesystem::path cohort;
    std::string patient;
    std::vector<std::string> cases;  ///< none: all of the patient
    bool on_reference_backend = false;
};

/// Told to nobody: `tell` gets one event after the other.
using TellEvent = std::function<void(const PatientEvent& event)>;

/// Prepares the reference once and recovers the targets one after the other, each into a folder of
/// its own that is whole or not there. What fails is told; only a signal or an error in telling is
/// thrown. Returns an exit code: 0, or what ended the patient.
int run_patient(const PatientJob& job, const TellEvent& tell, const ProgressSink& progress);

/// The same for a plan with a `test_stub_s`, to test runners with: sleeps in the place of every
/// computation, and does what ids ask for: "crash", "hang", "silent" (ends well, without a
/// result), "fail-4" (ends with that code); "once" after that only in a first attempt.
int run_stub_patient(const PlanFile& plan, const PatientJob& job, const TellEvent& tell);

/// The cases of a job that the plan has and does not exclude, in its order.
std::vector<const CohortCase*> cases_of(const CohortPatient& patient, const PatientJob& job);

/// Writes a case folder: what `fill` writes, and case.json. An older one is replaced.
void write_case(const std::filesystem::path& folder, const CaseRecord& record,
                const std::function<void(const std::filesystem::path& inside)>& fill);

/// Of the process so far, MB.
double peak_memory_mb();
std::string host_name();

}  // namespace palpate
