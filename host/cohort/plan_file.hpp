// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host/cohort/cohort_plan.hpp"

namespace palpate {

/// The plan of a cohort, read patient by patient: what it holds in memory does not grow with the
/// pairs. It has the list of patients (plan_patients.tsv), and where in plan.tsv their rows are.
class PlanFile {
public:
    /// Throws Error(input_unreadable) if there is no plan, or if its files do not belong together.
    explicit PlanFile(const std::filesystem::path& folder);
    ~PlanFile();
    PlanFile(const PlanFile&) = delete;
    PlanFile& operator=(const PlanFile&) = delete;

    const PlanHead& head() const { return head_; }
    std::size_t num_patients() const { return places_.size(); }
    std::size_t num_cases() const;  ///< that are not excluded
    /// Core seconds of each patient.
    std::vector<double> estimates_s() const;
    /// Throws Error(input_unreadable) if its rows are not those that were planned.
    CohortPatient patient(std::size_t position) const;
    /// Throws Error(invalid_argument) for a patient that the plan has not.
    CohortPatient patient(const std::string& id) const;

private:
    struct Place {
        std::string id, sha256;  ///< the first digits of that of the rows
        std::uint64_t begin = 0;
        std::size_t bytes = 0, cases = 0;
        double estimate_s = 0;
    };
    std::string rows_of(const Place& place) const;

    std::filesystem::path folder_;
    PlanHead head_;
    std::vector<Place> places_;
    int file_ = -1;
};

/// Writes plan.tsv, plan_patients.tsv and plan.json into `folder`, read-only; an older plan there
/// is replaced. Throws Error(output_failed).
void write_plan(const CohortPlan& plan, const std::filesystem::path& folder);

/// All of it in memory: of small cohorts. Throws as PlanFile.
CohortPlan read_plan(const std::filesystem::path& folder);

}  // namespace palpate
