// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/patient.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "host/apps/recover/modelling/build_model.hpp"
#include "host/apps/recover/pipeline/recover.hpp"
#include "host/apps/recover/report/result_folder.hpp"
#include "host/apps/recover/run/recover_table.hpp"
#include "host/cohort/case_card.hpp"
#include "host/cohort/cohort_folder.hpp"
#include "host/cohort/kept_result.hpp"
#include "host/cohort/recover_choice.hpp"
#include "host/io/output_folder.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"
#include "solver/base/serial_blas.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

/// Text without the names of the inputs: those may be of people.
class Aliases {
public:
    void add(const fs::path& path, const std::string& alias) {
        for (const std::string& name : {path.string(), path.filename().string()})
            if (!name.empty()) names_.emplace_back(name, alias);
    }
    std::string in(std::string text) const {
        for (const auto& [name, alias] : names_)
            for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos;
                 at += alias.size())
                text.replace(at, name.size(), alias);
        return text;
    }

private:
    std::vector<std::pair<std::string, std::string>> names_;
};

RegionRecord region_record(const RegionResult& region, const RecoveryResult& result) {
    RegionRecord row{region.name, name_of(region.verdict)};
    row.e_low_kpa = region.interval_kpa[0];
    row.e_high_kpa = region.interval_kpa[1];
    if (region.verdict != Verdict::not_identifiable) {
        row.e_kpa = region.stiffness_kpa;
        row.sd_ln = region.sd_ln;
        // Of several answers, or images in doubt, no one Gaussian is the data's.
        if (region.other_answers_kpa.empty() && !region.contradicts_prior)
            take_prior_out(row, prior_median_kpa(result.settings),
                           result.settings.prior.stiffness_sd_ln);
    }
    for (const SurfaceResult& surface : result.surfaces) {
        if (surface.region != region.region) continue;
        row.dice = surface.dice_after;
        row.mean_distance_mm = surface.mean_distance_mm_after;
    }
    return row;
}

/// The process of a patient.
class PatientWork {
public:
    PatientWork(const PatientJob& job, const TellEvent& tell, const ProgressSink& progress)
        : folder_(job.cohort),
          plan_(PlanFile(job.cohort).head()),
          patient_(PlanFile(job.cohort).patient(job.patient)),
          tell_(tell),
          progress_([this, &progress](const Progress& step) {
              if (progress) progress({step.stage, step.fraction, aliases_.in(step.message)});
          }) {
        aliases_.add(patient_.reference, "reference");
        for (const CohortCase& c : patient_.cases) aliases_.add(c.target, c.target_name);
        aliases_.add(patient_.initial_transform, "initial transform");
        for (const CohortCase* c : cases_of(patient_, job)) {
            const CaseStatus status = folder_.state_of(patient_, *c).status;
            if (status != CaseStatus::done && status != CaseStatus::not_converged)
                cases_.push_back(c);
        }
        toml_ = plan_.recover_toml;
        if (job.on_reference_backend) choose_reference_backend();
    }

    int run() {
        try {
            recover_cases();
        } catch (const Error& error) {
            if (error.code() == ErrorCode::cancelled) throw;
            const int code = exit_code_of(error.code());
            tell_({PatientEvent::Kind::patient_failed, "", code, aliases_.in(error.what())});
            return code;
        }
        return 0;
    }

private:
    void choose_reference_backend() {
        const std::size_t old = toml_.find("backend = ");
        if (old != std::string::npos) toml_.erase(old, toml_.find('\n', old) + 1 - old);
        toml_ += "backend = \"reference\"\n";
    }

    void recover_cases() {
        if (cases_.empty()) return;
        const SerialBlas serial;  // patients side by side leave it no core of its own
        const OptionValues values = recover_values(toml_, patient_.align);
        RecoverOptions options =
            recover_options_of(values, read_settings(folder_.settings_file(patient_.config)));
        options.initial_transform = patient_.initial_transform;
        const Segmentation reference = read_as(patient_.reference, "reference");
        TargetSinks sinks;
        sinks.result = [&](std::size_t k, RecoveryResult result, double seconds) {
            keep(*cases_[k], result, seconds);
        };
        sinks.failed = [&](std::size_t k, const Error& error) { fail(*cases_[k], error); };
        sinks.started = [&](std::size_t k) { tell_({PatientEvent::Kind::started, cases_[k]->id}); };
        if (plan_.keep == KeptFiles::compact)
            sinks.prepared = [&](const BodyMesh& body) { body_ = body_bytes(body); };
        sinks.goes_on_without = true;
        const auto read = [&](std::size_t k) {
            return read_as(cases_[k]->target, cases_[k]->target_name);
        };
        recover_each(reference, cases_.size(), read, options, sinks, progress_);
    }

    Segmentation read_as(const fs::path& path, const std::string& alias) const {
        Segmentation read = read_segmentation(path, progress_);
        read.name = alias;
        for (std::string& warning : read.warnings) warning = aliases_.in(warning);
        return read;
    }

    void fail(const CohortCase& c, const Error& error) const {
        tell_({PatientEvent::Kind::failed, c.id, exit_code_of(error.code()),
               aliases_.in(error.what())});
    }

    void keep(const CohortCase& c, const RecoveryResult& result, double seconds) const {
        CaseRecord record{patient_.id, c.id, c.key, version_text()};
        record.converged = result.termination.converged;
        if (result.contours) record.contour_sd_mm = result.contours->sd_mm;
        record.seconds = seconds;
        record.peak_memory_mb = peak_memory_mb();
        record.device = result.device.device;
        record.host = host_name();
        record.flags = flags_of_result(result);
        for (const RegionResult& region : result.regions)
            if (region.unknown) record.regions.push_back(region_record(region, result));
        const fs::path patient_folder = folder_.patient_folder(patient_);
        if (plan_.keep == KeptFiles::compact)
            record.mesh = keep_mesh(result, body_, patient_folder / "reference");
        write_case(patient_folder / c.id, record, [&](const fs::path& inside) {
            write_kept_result(result, plan_.keep, inside);
            const std::string card = case_card(result);
            if (!card.empty()) write_text_file(inside / case_card_name, card);
        });
        tell_({PatientEvent::Kind::done, c.id, 0, "", record});
    }

    CohortFolder folder_;
    PlanHead plan_;
    CohortPatient patient_;
    const TellEvent& tell_;
    ProgressSink progress_;
    Aliases aliases_;
    std::string toml_;
    std::string body_;                      ///< bytes of the mesh, where it is kept
    std::vector<const CohortCase*> cases_;  ///< of the job, without a result
};

}  // namespace

int run_patient(const PatientJob& job, const TellEvent& tell, const ProgressSink& progress) {
    return PatientWork(job, tell, progress).run();
}

std::vector<const CohortCase*> cases_of(const CohortPatient& patient, const PatientJob& job) {
    std::vector<const CohortCase*> cases;
    for (const CohortCase& c : patient.cases) {
        const bool is_asked = job.cases.empty() || std::find(job.cases.begin(), job.cases.end(),
                                                             c.id) != job.cases.end();
        if (is_asked && c.excluded.empty()) cases.push_back(&c);
    }
    return cases;
}

void write_case(const fs::path& folder, const CaseRecord& record,
                const std::function<void(const fs::path&)>& fill) {
    write_folder_atomically(folder, true, [&](const fs::path& inside) {
        fill(inside);
        write_text_file(inside / case_record_name, record_line(record) + "\n");
    });
}

double peak_memory_mb() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1024;
}

std::string host_name() {
    std::array<char, 256> name{};
    if (::gethostname(name.data(), name.size() - 1) != 0) return "unknown";
    return name.data();
}

}  // namespace palpate
