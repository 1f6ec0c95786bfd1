// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "host/cohort/cohort_folder.hpp"
#include "host/cohort/patient.hpp"
#include "host/io/output_folder.hpp"
#include "host/system/interrupt.hpp"
#include "host/system/version.hpp"

namespace palpate {
namespace {

/// Slices of a tenth of a second, so that signals end it.
void sleep_stub(double seconds) {
    for (; seconds > 0; seconds -= 0.1) {
        throw_if_interrupted();
        ::usleep(static_cast<useconds_t>(1e6 * (seconds < 0.1 ? seconds : 0.1)));
    }
}

/// Whether a case that misbehaves "once" has done so before; remembered in a file of the cohort.
bool is_second_attempt(const CohortFolder& folder, const CohortPatient& patient,
                       const CohortCase& c) {
    const auto mark = folder.path() / "logs" / fmt::format("{}_{}.once", patient.id, c.id);
    if (std::filesystem::exists(mark)) return true;
    write_text_file(mark, "");
    return false;
}

/// Throws, ends the process or does nothing, as the id asks.
void misbehave(const CohortFolder& folder, const CohortPatient& patient, const CohortCase& c) {
    const std::string& id = c.id;
    if (id.find("once") != std::string::npos && is_second_attempt(folder, patient, c)) return;
    if (id.starts_with("crash")) {
        std::signal(SIGSEGV, SIG_DFL);
        ::raise(SIGSEGV);
    }
    if (id.starts_with("silent")) ::_exit(0);
    while (id.starts_with("hang")) {
    }
}

}  // namespace

int run_stub_patient(const CohortPlan& plan, const PatientJob& job, const TellEvent& tell) {
    const CohortFolder folder(job.cohort);
    const CohortPatient& patient = plan.patient(job.patient);
    for (const CohortCase* c : cases_of(patient, job)) {
        if (folder.state_of(patient, *c).status == CaseStatus::done) continue;
        tell({PatientEvent::Kind::started, c->id});
        sleep_stub(*plan.test_stub_s);
        misbehave(folder, patient, *c);
        if (c->id.starts_with("fail-")) {
            tell({PatientEvent::Kind::failed, c->id, c->id[5] - '0', "the test stub was asked to"});
            continue;
        }
        CaseRecord record{patient.id, c->id, c->key, version_text()};
        record.seconds = *plan.test_stub_s;
        record.peak_memory_mb = peak_memory_mb();
        record.device = "test stub";
        record.host = host_name();
        RegionRecord region{"test stub", "recovered", 50, 0.1, 41, 61};
        take_prior_out(region, 100, 1.2);
        record.regions.push_back(region);
        write_case(folder.case_folder(patient, *c), record, [](const std::filesystem::path&) {});
        tell({PatientEvent::Kind::done, c->id, 0, "", record});
    }
    return 0;
}

}  // namespace palpate
