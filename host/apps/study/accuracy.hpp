// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/study/published.hpp"
#include "host/apps/study/study.hpp"
#include "host/estimate/verdict.hpp"

namespace palpate {

/// A recovered stiffness beside the one that was expected, kPa.
struct Estimate {
    double expected_kpa = 0, found_kpa = 0;
    std::array<double, 2> interval_kpa{0, 0};       ///< 95 %; {0, 0} if nobody gave one
    std::optional<Verdict> verdict = std::nullopt;  ///< empty if nobody gave one

    double error_percent() const { return 100 * (found_kpa / expected_kpa - 1); }
    bool has_interval() const { return interval_kpa[1] > 0; }
    bool holds_truth() const {
        return interval_kpa[0] <= expected_kpa && expected_kpa <= interval_kpa[1];
    }
};

/// Of one column; empty where the row has none. Throws Error(invalid_argument) for a word that is
/// no verdict.
std::optional<Verdict> verdict_in(const Row& row, const std::string& column);

/// Columns expected_kpa (or true_kpa where there is none), found_kpa, low_kpa, high_kpa, verdict.
/// Throws Error(invalid_argument) for a verdict that is none.
std::vector<Estimate> estimates_of(const std::vector<Row>& rows);
std::vector<Estimate> estimates_of(const std::vector<PublishedStiffness>& published);

/// Errors of the estimates of one range of stiffness.
struct Accuracy {
    std::string name;  ///< "40 to 150 kPa", "all"
    std::size_t count = 0;
    double median_abs_error_percent = 0, mean_signed_error_percent = 0;
    double worst_abs_error_percent = 0;
    std::size_t num_intervals = 0, num_holding = 0;
    std::array<double, 2> holding_range{0, 1};  ///< 95 % binomial, of num_holding / num_intervals
};

Accuracy accuracy_of(std::string name, const std::vector<Estimate>& estimates);

/// By expected stiffness: 40 to 150, 150 to 200, 200 to 350 kPa (upper ends belong to the lower
/// group, but 200 kPa to the last), and all; groups without estimates are left out.
std::vector<Accuracy> accuracy_by_group(const std::vector<Estimate>& estimates);

/// "all.median_abs_error_percent" and so on.
std::vector<Fact> facts_of(const std::vector<Accuracy>& groups);

}  // namespace palpate
