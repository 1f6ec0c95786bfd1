// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/expand.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/apps/recover/modelling/settings.hpp"
#include "host/apps/recover/report/result_folder.hpp"
#include "host/cohort/cohort_folder.hpp"
#include "host/cohort/content_key.hpp"
#include "host/cohort/kept_result.hpp"
#include "host/cohort/plan_file.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

struct Chosen {
    const CohortPatient* patient;
    const CohortCase* one;
    std::string name() const { return patient->id + "/" + one->id; }
};

std::vector<Chosen> all_cases(const CohortPlan& plan) {
    std::vector<Chosen> found;
    for (const CohortPatient& patient : plan.patients)
        for (const CohortCase& c : patient.cases) found.push_back({&patient, &c});
    return found;
}

bool has_result(const CaseState& state) {
    return state.status == CaseStatus::done || state.status == CaseStatus::not_converged;
}

std::vector<Chosen> chosen_cases(const CohortFolder& folder, const CohortPlan& plan,
                                 const std::vector<std::string>& names) {
    std::vector<Chosen> all = all_cases(plan), found;
    if (names.empty()) {
        std::erase_if(
            all, [&](const Chosen& c) { return !has_result(folder.state_of(*c.patient, *c.one)); });
        return all;
    }
    for (const std::string& name : names) {
        const auto at = std::ranges::find_if(all, [&](const auto& c) { return c.name() == name; });
        if (at == all.end())
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("the plan has no case '{}'; name it as its folder is called, "
                                    "for example {}",
                                    name, all.empty() ? "p1/target-01" : all.front().name()));
        found.push_back(*at);
    }
    return found;
}

Segmentation checked_volume(const fs::path& path, const std::string& sha256, const Chosen& chosen,
                            const std::string& alias) {
    if (sha256_of_file(path) != sha256)
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{}: the file of its {} is not the one that was planned; plan and "
                                "run the cohort again",
                                chosen.name(), alias));
    Segmentation volume = read_segmentation(path);
    volume.name = alias;
    return volume;
}

void expand_case(const CohortFolder& folder, const Chosen& chosen, const fs::path& out) {
    const CohortPatient& patient = *chosen.patient;
    const CaseState state = folder.state_of(patient, *chosen.one);
    if (!has_result(state))
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{}: there is no result of it ({}); run the cohort first",
                                chosen.name(), name_of(state.status)));
    if (state.record->mesh.empty())
        throw Error(ErrorCode::input_unusable,
                    fmt::format("{}: only its table was kept, or all of it is there; plan with "
                                "--keep compact to expand cases",
                                chosen.name()));
    const Settings settings = read_settings(folder.settings_file(patient.config));
    const CompactResult kept = read_compact_result(
        folder.case_folder(patient, *chosen.one),
        folder.patient_folder(patient) / "reference" / body_name_of(state.record->mesh));
    const auto reference =
        checked_volume(patient.reference, patient.reference_sha256, chosen, "reference");
    const auto target = checked_volume(chosen.one->target, chosen.one->target_sha256, chosen,
                                       chosen.one->target_name);
    write_result(expand_result(kept, reference, target, settings),
                 out / patient.id / chosen.one->id);
}

}  // namespace

std::size_t expand_cases(const fs::path& cohort, const std::vector<std::string>& names,
                         const fs::path& out, const ProgressSink& progress) {
    const CohortFolder folder(cohort);
    const CohortPlan plan = read_plan(cohort);
    const std::vector<Chosen> chosen = chosen_cases(folder, plan, names);
    std::size_t made = 0;
    for (std::size_t k = 0; k < chosen.size(); ++k) {
        report_progress(progress, "expanding", double(k) / double(chosen.size()), chosen[k].name());
        if (fs::exists(out / chosen[k].name() / "result.json")) continue;
        expand_case(folder, chosen[k], out);
        ++made;
    }
    return made;
}

}  // namespace palpate
