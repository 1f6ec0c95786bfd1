// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "host/apps/study/statistics.hpp"

namespace palpate {

std::optional<Verdict> verdict_in(const Row& row, const std::string& column) {
    return row.has(column) ? std::optional(verdict_of(row.text(column))) : std::nullopt;
}

std::vector<Estimate> estimates_of(const std::vector<Row>& rows) {
    std::vector<Estimate> estimates;
    for (const Row& row : rows) {
        Estimate estimate;
        estimate.expected_kpa = row.number(row.has("expected_kpa") ? "expected_kpa" : "true_kpa");
        estimate.found_kpa = row.number("found_kpa");
        estimate.verdict = verdict_in(row, "verdict");
        if (row.has("low_kpa") && row.has("high_kpa"))
            estimate.interval_kpa = {row.number("low_kpa"), row.number("high_kpa")};
        estimates.push_back(estimate);
    }
    return estimates;
}

std::vector<Estimate> estimates_of(const std::vector<PublishedStiffness>& published) {
    std::vector<Estimate> estimates;
    for (const auto& value : published)
        estimates.push_back({value.expected_kpa, value.found_kpa, {0, 0}});
    return estimates;
}

Accuracy accuracy_of(std::string name, const std::vector<Estimate>& estimates) {
    Accuracy accuracy;
    accuracy.name = std::move(name);
    accuracy.count = estimates.size();
    std::vector<double> error, size;
    for (const Estimate& estimate : estimates) {
        error.push_back(estimate.error_percent());
        size.push_back(std::abs(error.back()));
        accuracy.worst_abs_error_percent = std::max(accuracy.worst_abs_error_percent, size.back());
        accuracy.num_intervals += estimate.has_interval();
        accuracy.num_holding += estimate.has_interval() && estimate.holds_truth();
    }
    accuracy.median_abs_error_percent = median_of(size);
    accuracy.mean_signed_error_percent = mean_of(error);
    accuracy.holding_range = binomial_range(accuracy.num_holding, accuracy.num_intervals);
    return accuracy;
}

std::vector<Accuracy> accuracy_by_group(const std::vector<Estimate>& estimates) {
    const std::vector<std::pair<std::string, std::function<bool(double)>>> groups{
        {"up to 150 kPa", [](double e) { return e <= 150; }},
        {"150 to 200 kPa", [](double e) { return e > 150 && e < 200; }},
        {"from 200 kPa", [](double e) { return e >= 200; }},
        {"all", [](double) { return true; }}};
    std::vector<Accuracy> result;
    for (const auto& [name, belongs] : groups) {
        std::vector<Estimate> some;
        std::copy_if(estimates.begin(), estimates.end(), std::back_inserter(some),
                     [&fits = belongs](const Estimate& e) { return fits(e.expected_kpa); });
        if (!some.empty()) result.push_back(accuracy_of(name, some));
    }
    return result;
}

std::vector<Fact> facts_of(const std::vector<Accuracy>& groups) {
    std::vector<Fact> facts;
    for (const Accuracy& group : groups) {
        const auto add = [&](const char* name, double value) {
            facts.emplace_back(group.name + ": " + name, value);
        };
        add("count", double(group.count));
        add("median_abs_error_percent", group.median_abs_error_percent);
        add("mean_signed_error_percent", group.mean_signed_error_percent);
        add("worst_abs_error_percent", group.worst_abs_error_percent);
        if (group.num_intervals == 0) continue;
        add("intervals_holding_truth", double(group.num_holding));
        add("share_holding_low", group.holding_range[0]);
        add("share_holding_high", group.holding_range[1]);
    }
    return facts;
}

}  // namespace palpate
