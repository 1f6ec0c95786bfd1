// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "host/cohort/case_flags.hpp"

namespace palpate {

/// What the tables tell of one unknown region of a case; NaN where there is no number.
struct RegionRecord {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();
    std::string region, verdict;
    double e_kpa = none, sd_ln = none;            ///< none if it is not identifiable
    double e_low_kpa = none, e_high_kpa = none;   ///< 95 % interval
    double ln_e_data = none, sd_data = none;      ///< with the prior taken out
    double dice = none, mean_distance_mm = none;  ///< after the deformation
};

/// The file case.json of a case folder: where its result comes from, and its rows of the tables.
struct CaseRecord {
    std::string patient, case_id, key, version;
    bool converged = true;
    double contour_sd_mm = RegionRecord::none;
    double seconds = 0, peak_memory_mb = 0;
    std::string device = {}, host = {};
    std::string mesh = {};  ///< file in the patient's folder `reference`; empty: none is kept
    CaseFlags flags = {};   ///< that the result by itself shows
    std::vector<RegionRecord> regions = {};
};

inline constexpr const char* case_record_name = "case.json";

/// One line of JSON without its end, or the file.
std::string record_line(const CaseRecord& record);
/// Empty if it is none.
std::optional<CaseRecord> record_of(const std::string& json);

/// Posterior and prior normal in ln E, the prior taken out of the posterior:
///   1/sd_data^2 = 1/sd_ln^2 - 1/prior_sd^2,  ln_e_data = sd_data^2 (ln_e/sd_ln^2 -
///   ln_prior/prior_sd^2)
/// Leaves NaN where the data add nothing. `e_kpa` and `sd_ln` of `region` must be set.
void take_prior_out(RegionRecord& region, double prior_median_kpa, double prior_sd_ln);

/// The file of a case that failed for good.
struct FailureRecord {
    std::string key, sentence, host, log_tail;
    int code = 1, attempts = 1;
};
std::string failure_text(const FailureRecord& failure);
std::optional<FailureRecord> failure_of(const std::string& json);

}  // namespace palpate
