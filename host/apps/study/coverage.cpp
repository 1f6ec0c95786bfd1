// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <regex>

#include "host/apps/study/calibration.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/apps/study/statistics.hpp"
#include "host/apps/study/tables.hpp"

namespace palpate {
namespace {

StudySection calibration_section(const std::vector<Calibration>& families) {
    return {
        "Are the intervals honest, by family",
        calibration_table(families).html("beside") +
            "<p class='caption'>Phantoms of one family are loaded alike, or their contours are "
            "off in the same way. Error / claimed deviation: root mean square of the error of "
            "ln E over the deviation that the interval claims, its width in ln E over 3.92; 1 is "
            "honest, more is too sure. In brackets: 95 % ranges of what many phantoms would "
            "show.</p>",
        {}};
}

StudyReport coverage_report(const std::vector<Row>& rows) {
    const auto ours = estimates_of(rows);
    const auto published = estimates_of(published_recovery());
    const auto groups = accuracy_by_group(ours);
    const Accuracy& all = groups.back();
    const auto families = calibration_by_family(rows);
    std::vector<double> landmarks;
    std::size_t num_converged = 0;
    for (const Row& row : rows) {
        landmarks.push_back(row.number("landmark_mean_mm"));
        num_converged += row.flag("converged");
    }

    StudyReport report;
    report.headline = fmt::format(
        "The stiffness is found within {:.0f} % (median); {} of {} intervals hold the truth",
        all.median_abs_error_percent, all.num_holding, all.num_intervals);
    report.sentences = {
        fmt::format("{} pelvis phantom{} of varied anatomy and load, whose prostate has a known "
                    "stiffness between 40 and 350 kPa: made, labelled in voxels and recovered from "
                    "the two label volumes alone.",
                    rows.size(), rows.size() == 1 ? "" : "s"),
        fmt::format(
            "Intervals of 95 % that are honest would hold the truth in about 95 of 100 cases; "
            "these do so in {:.0f} % (95 % range {:.0f} to {:.0f} %). Points inside the "
            "prostate are found within {:.2f} mm on average. The search converged in {} "
            "of {}.",
            100.0 * double(all.num_holding) / double(all.num_intervals), 100 * all.holding_range[0],
            100 * all.holding_range[1], mean_of(landmarks), num_converged, rows.size())};
    report.sections = {calibration_section(families),
                       accuracy_section(ours, published, "true E of the prostate, kPa")};
    report.facts = facts_of(groups);
    report.facts.emplace_back("mean_landmark_error_mm", mean_of(landmarks));
    for (const Calibration& family : families) {
        const std::string name = std::regex_replace(family.family, std::regex(": "), "_") + ".";
        report.facts.emplace_back(name + "bias_ln", family.bias_ln);
        report.facts.emplace_back(name + "median_abs_ln_error", family.median_abs_ln_error);
        report.facts.emplace_back(name + "error_over_claimed", family.error_over_claimed);
        report.facts.emplace_back(name + "narrowest_factor", family.narrowest_factor);
    }
    report.text = accuracy_table(groups, {}).plain() + "\n" + calibration_table(families).plain();
    return report;
}

std::vector<std::string> coverage_columns() {
    std::vector<std::string> columns{"anatomy", "load", "contours"};
    const std::vector<std::string> further = pelvis_columns();
    columns.insert(columns.end(), further.begin(), further.end());
    return columns;
}

}  // namespace

Study make_coverage_study(const StudyOptions& options) {
    Study study{"coverage",
                "Do the 95 % intervals hold the truth",
                pelvis_settings(options),
                coverage_columns(),
                {},
                coverage_report};
    for (int k = 0; k < options.phantoms; ++k) {
        const unsigned seed = options.first_seed + unsigned(k);
        PelvisCase work;
        work.truth = pelvis_options(options, seed, drawn_stiffness_kpa(seed));
        work.labels = {{"anatomy", name_of(work.truth.anatomy)},
                       {"load", name_of(work.truth.load)},
                       {"contours", to_text(work.truth.contours)}};
        StudyCase one = study_case(work, options);
        one.id = fmt::format("seed-{}", seed);
        study.cases.push_back(std::move(one));
    }
    return study;
}

}  // namespace palpate
