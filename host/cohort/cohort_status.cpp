// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/cohort_status.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "host/cohort/case_states.hpp"
#include "host/cohort/claim.hpp"
#include "host/cohort/plan_file.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr CaseStatus all_status[] = {CaseStatus::done,    CaseStatus::not_converged,
                                     CaseStatus::failed,  CaseStatus::stale,
                                     CaseStatus::waiting, CaseStatus::excluded};

constexpr std::size_t fewest_a_thread = 100;  // patients

/// Of the patients `first` up to `end`.
CohortStatus counts_of(const CohortFolder& folder, const PlanFile& plan, const CaseStates& all,
                       std::size_t first, std::size_t end) {
    CohortStatus status;
    for (std::size_t p = first; p < end; ++p) {
        const CohortPatient patient = plan.patient(p);
        const std::vector<CaseState> states = all.of(patient, false);
        bool is_whole = true;
        for (std::size_t k = 0; k < states.size(); ++k) {
            add_to(status, patient.cases[k], states[k]);
            is_whole &=
                states[k].status != CaseStatus::waiting && states[k].status != CaseStatus::stale;
        }
        if (!is_whole && Claim::is_held(folder.claim_file(patient))) ++status.in_work;
    }
    return status;
}

void add_counts(CohortStatus& sum, const CohortStatus& part) {
    for (std::size_t k = 0; k < sum.counts.size(); ++k) sum.counts[k] += part.counts[k];
    sum.in_work += part.in_work;
    for (const auto& [reason, times] : part.excluded_for) sum.excluded_for[reason] += times;
    for (const auto& [sentence, times] : part.failed_with) sum.failed_with[sentence] += times;
}

}  // namespace

int CohortStatus::exit_code() const {
    if (count(CaseStatus::waiting) + count(CaseStatus::stale) > 0)
        return exit_code_of(ErrorCode::cancelled);
    const bool is_good = count(CaseStatus::failed) + count(CaseStatus::not_converged) == 0;
    return is_good ? 0 : exit_code_not_converged;
}

void add_to(CohortStatus& status, const CohortCase& c, const CaseState& state) {
    ++status.counts[static_cast<std::size_t>(state.status)];
    if (state.status == CaseStatus::excluded) ++status.excluded_for[c.excluded];
    if (state.failure) ++status.failed_with[state.failure->sentence];
}

CohortStatus cohort_status(const std::filesystem::path& path) {
    const CohortFolder folder(path);
    const PlanFile plan(path);
    const CaseStates all(folder);
    CohortStatus status;
    status.patients = plan.num_patients();
    status.bad_rows_left_out = plan.head().num_bad_rows;
    const std::size_t parts =
        std::clamp<std::size_t>(plan.num_patients() / fewest_a_thread, 1,
                                std::max(1u, std::thread::hardware_concurrency()));
    std::vector<std::future<CohortStatus>> counted;
    for (std::size_t part = 0; part < parts; ++part)
        counted.push_back(
            std::async(parts > 1 ? std::launch::async : std::launch::deferred, [&, part] {
                return counts_of(folder, plan, all, plan.num_patients() * part / parts,
                                 plan.num_patients() * (part + 1) / parts);
            }));
    for (std::future<CohortStatus>& part : counted) add_counts(status, part.get());
    return status;
}

std::string status_text(const CohortStatus& status) {
    std::string text =
        fmt::format("{:>8}  patients, {} of them in work\n", status.patients, status.in_work);
    for (const CaseStatus one : all_status)
        if (status.count(one) > 0)
            text += fmt::format("{:>8}  {}\n", status.count(one), name_of(one));
    if (status.bad_rows_left_out > 0)
        text += fmt::format("{:>8}  bad rows left out of the plan (problems.tsv)\n",
                            status.bad_rows_left_out);
    for (const auto& [sentence, times] : status.failed_with)
        text += fmt::format("failed, {} times: {}\n", times, sentence);
    return text;
}

std::string status_json(const CohortStatus& status) {
    nlohmann::ordered_json json{{"patients", status.patients}, {"in_work", status.in_work}};
    for (const CaseStatus one : all_status) json["cases"][name_of(one)] = status.count(one);
    json["bad_rows_left_out"] = status.bad_rows_left_out;
    json["failed_with"] = status.failed_with;
    json["excluded_for"] = status.excluded_for;
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace palpate
