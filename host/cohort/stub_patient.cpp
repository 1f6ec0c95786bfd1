// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "host/cohort/case_card.hpp"
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

/// An ellipsoid with its axes along those of the patient; mm.
Surface ellipsoid(const Vec3& centre, const Vec3& radii) {
    constexpr Index rings = 16, around = 24;
    Surface surface;
    for (Index r = 0; r <= rings; ++r)
        for (Index a = 0; a < around; ++a) {
            const double polar = std::numbers::pi * r / rings;
            const double turn = 2 * std::numbers::pi * a / around;
            const Vec3 way(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                           std::cos(polar));
            surface.vertices.push_back(centre + radii.cwiseProduct(way));
        }
    const auto at = [](Index r, Index a) { return r * around + a % around; };
    for (Index r = 0; r < rings; ++r)
        for (Index a = 0; a < around; ++a) {
            surface.triangles.push_back({at(r, a), at(r + 1, a), at(r + 1, a + 1)});
            surface.triangles.push_back({at(r, a), at(r + 1, a + 1), at(r, a + 1)});
        }
    return surface;
}

/// Two ellipsoids that moved a little, by the key.
std::string stub_card(const std::string& key) {
    const double move = double(std::stoul(key.substr(0, 4), nullptr, 16)) / 65536;
    const auto organ = [&](const char* colour, const Vec3& centre, const Vec3& radii) {
        const Vec3 shift(2 * move, -4 * move, 3 * move);
        return CardOrgan{colour, ellipsoid(centre, radii), ellipsoid(centre + shift, radii),
                         ellipsoid(centre + shift + Vec3(0.4, 0.2, 0.3), radii)};
    };
    return card_svg(
        {organ("#b3541e", {0, -30, 12}, {28, 24, 22}), organ("#1d5f91", {0, 0, 0}, {22, 17, 19})},
        {0, -8, 3});
}

/// Of "log-300": 300.
int megabytes_of(const std::string& id) { return std::stoi(id.substr(id.find('-') + 1)); }

/// Throws, ends the process or does nothing, as the id asks.
void misbehave(const CohortFolder& folder, const CohortPatient& patient, const CohortCase& c) {
    const std::string& id = c.id;
    if (id.find("once") != std::string::npos && is_second_attempt(folder, patient, c)) return;
    if (id.starts_with("crash")) {
        std::signal(SIGSEGV, SIG_DFL);
        ::raise(SIGSEGV);
    }
    if (id.starts_with("silent")) ::_exit(0);
    if (id.starts_with("stop")) ::raise(SIGSTOP);
    if (id.starts_with("memory")) {  // as much as there is, in steps that a watcher sees
        std::vector<std::vector<char>> taken;
        for (;;) taken.emplace_back(std::size_t(50) << 20, 'm'), ::usleep(50000);
    }
    if (id.starts_with("log")) {
        const std::string line(1023, 'l');
        for (int megabyte = 0; megabyte < megabytes_of(id); ++megabyte)
            for (int k = 0; k < 1024; ++k) fmt::print(stderr, "{}\n", line);
        ::_exit(1);
    }
    while (id.starts_with("hang")) {
    }
}

}  // namespace

int run_stub_patient(const PlanFile& plan, const PatientJob& job, const TellEvent& tell) {
    const CohortFolder folder(job.cohort);
    const CohortPatient patient = plan.patient(job.patient);
    for (const CohortCase* c : cases_of(patient, job)) {
        if (folder.state_of(patient, *c).status == CaseStatus::done) continue;
        tell({PatientEvent::Kind::started, c->id});
        sleep_stub(*plan.head().test_stub_s);
        misbehave(folder, patient, *c);
        if (c->id.starts_with("fail-")) {
            tell({PatientEvent::Kind::failed, c->id, c->id[5] - '0', "the test stub was asked to"});
            continue;
        }
        CaseRecord record{patient.id, c->id, c->key, version_text()};
        record.seconds = *plan.head().test_stub_s;
        record.peak_memory_mb = peak_memory_mb();
        record.device = "test stub";
        record.host = host_name();
        RegionRecord region{"test stub", "recovered", 50, 0.1, 41, 61};
        take_prior_out(region, 100, 1.2);
        record.regions.push_back(region);
        write_case(folder.case_folder(patient, *c), record,
                   [&](const std::filesystem::path& inside) {
                       write_text_file(inside / case_card_name, stub_card(c->key));
                   });
        tell({PatientEvent::Kind::done, c->id, 0, "", record});
    }
    return 0;
}

}  // namespace palpate
