// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "host/cohort/cohort_status.hpp"
#include "host/cohort/cohort_tables.hpp"
#include "host/cohort/gallery.hpp"
#include "host/cohort/patient_strips.hpp"

namespace palpate {

/// Why pairs do not enter the means, each pair once, in the order in which it is asked.
class ExclusionFlow {
public:
    void leave_out(const std::string& reason) { ++count_of(reason); }
    void take() { ++taken_; }
    std::size_t taken() const { return taken_; }
    std::size_t all() const;
    const std::vector<std::pair<std::string, std::size_t>>& reasons() const { return reasons_; }

private:
    std::size_t& count_of(const std::string& reason);
    std::vector<std::pair<std::string, std::size_t>> reasons_;
    std::size_t taken_ = 0;
};

/// What is collected of a cohort, as its pages show it.
struct CohortView {
    CohortStatus status;
    ExclusionFlow flow;
    std::vector<PatientRegion> regions;
    std::vector<PatientStrip> strips;  ///< of the same positions
    Gallery gallery;
};

/// The page of a cohort, with its first patients.
std::string cohort_page(const CohortView& view);
/// Further patients, for the folder `gallery`: name and content of each page.
std::vector<std::pair<std::string, std::string>> patient_pages(const CohortView& view);

}  // namespace palpate
