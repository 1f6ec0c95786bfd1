// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "host/apps/study/statistics.hpp"

namespace palpate {
namespace {

/// "slices" of "slices:0.5:4.6"
std::string kind_of(const std::string& contours) { return contours.substr(0, contours.find(':')); }

Calibration calibration_of(const std::string& family, const std::vector<Row>& rows) {
    Calibration result;
    result.family = family;
    result.count = rows.size();
    result.narrowest_factor = std::numeric_limits<double>::infinity();
    std::vector<double> sizes, errors;
    double squares = 0;
    for (const Row& row : rows) {
        const double error = row.number("ln_error");
        errors.push_back(error);
        sizes.push_back(std::abs(error));
        squares += std::pow(error / row.number("claimed_sd"), 2);
        result.num_holding += row.flag("holds_truth");
        result.narrowest_factor =
            std::min(result.narrowest_factor, row.number("high_kpa") / row.number("low_kpa"));
    }
    result.median_abs_ln_error = median_of(sizes);
    result.bias_ln = mean_of(errors);
    result.error_over_claimed = std::sqrt(squares / double(rows.size()));
    result.claim_range = deviation_range(result.error_over_claimed, rows.size());
    return result;
}

void add_groups(const std::map<std::string, std::vector<Row>>& groups,
                std::vector<Calibration>& families) {
    if (groups.size() < 2) return;
    for (const auto& [name, rows] : groups) families.push_back(calibration_of(name, rows));
}

}  // namespace

std::vector<Calibration> calibration_by_family(const std::vector<Row>& rows) {
    std::map<std::string, std::vector<Row>> by_anatomy, by_load, by_contours;
    for (const Row& row : rows) {
        by_anatomy["anatomy: " + row.text("anatomy")].push_back(row);
        by_load["load: " + row.text("load")].push_back(row);
        by_contours["contours: " + kind_of(row.text("contours"))].push_back(row);
    }
    std::vector<Calibration> families;
    add_groups(by_anatomy, families);
    add_groups(by_load, families);
    add_groups(by_contours, families);
    families.push_back(calibration_of("all", rows));
    return families;
}

StudyTable calibration_table(const std::vector<Calibration>& families) {
    StudyTable table;
    table.header = {"family",
                    "phantoms",
                    "intervals that hold",
                    "median |error| of ln E",
                    "bias of ln E",
                    "error / claimed deviation",
                    "narrowest interval"};
    for (const Calibration& family : families) {
        const auto range = binomial_range(family.num_holding, family.count);
        table.lines.push_back({family.family, fmt::format("{}", family.count),
                               fmt::format("{} ({:.0f} to {:.0f} %)", family.num_holding,
                                           100 * range[0], 100 * range[1]),
                               fmt::format("{:.2f}", family.median_abs_ln_error),
                               fmt::format("{:+.2f}", family.bias_ln),
                               fmt::format("{:.2f} ({:.2f} to {:.2f})", family.error_over_claimed,
                                           family.claim_range[0], family.claim_range[1]),
                               fmt::format("x {:.1f}", family.narrowest_factor)});
    }
    return table;
}

}  // namespace palpate
