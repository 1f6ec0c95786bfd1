// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/cohort/case_flags.hpp"
#include "host/cohort/cohort_folder.hpp"

namespace palpate {

/// Collects the cases of a cohort and writes gallery.html: pages of 200 cards, the worst first,
/// whose rows are in the folder `gallery` and whose pictures in the case folders. All is opened
/// from disk: nothing is fetched.
class Gallery {
public:
    /// A case with a result or a failure; `flags`: all but `slow`. Returns its number, from 0.
    std::size_t add(const CohortFolder& folder, const CohortPatient& patient, const CohortCase& c,
                    const CaseState& state, CaseFlags flags, const std::string& rating);

    /// Sorts the cases, so that `place_of` is known. Before that `slow` is added to those that took
    /// more than three times the median.
    void sort();
    std::size_t num_cases() const { return cases_.size(); }
    /// From 1, the worst; after `sort`.
    std::size_t place_of(std::size_t number) const { return place_[number]; }
    /// Cases with each flag; after `sort`.
    std::vector<std::size_t> flag_counts() const;
    /// `more`: names and texts of further files for the folder. Throws Error(output_failed).
    void write(const std::filesystem::path& cohort,
               const std::vector<std::pair<std::string, std::string>>& more) const;

private:
    struct Case {
        std::size_t begin = 0;  ///< of its row in `rows_`
        std::uint32_t bytes = 0;
        float seconds = 0;
        CaseFlags flags;
    };
    std::string_view row_of(const Case& c) const {
        return std::string_view(rows_).substr(c.begin, c.bytes);
    }
    std::string chunk_text(std::size_t first) const;

    std::string rows_;  ///< JSON arrays without their end, one after the other
    std::vector<Case> cases_;
    std::vector<std::uint32_t> order_, place_;
    double low_kpa_ = 0, high_kpa_ = 0;  ///< of all moduli that were identified
};

}  // namespace palpate
