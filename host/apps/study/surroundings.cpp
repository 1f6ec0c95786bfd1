// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "host/apps/study/beside.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/page/numbers.hpp"

namespace palpate {
namespace {

constexpr double true_kpa = 20, assumed_kpa = 10;  // of the surrounding tissue

StudyTable surroundings_table(const std::vector<Row>& rows) {
    BesideTable table("expected E, kPa");
    for (const Row& row : rows)
        table.add(row.number("expected_kpa"), "palpate, seed " + row.text("seed"),
                  significant(row.number("found_kpa")));
    for (const auto& value : published_surroundings())
        table.add(value.expected_kpa, "published, " + value.scene, significant(value.found_kpa));
    return table.table();
}

StudyReport surroundings_report(const std::vector<Row>& rows) {
    const auto ours = estimates_of(rows);
    const auto published = estimates_of(published_surroundings());
    const auto groups = accuracy_by_group(ours);

    StudyReport report;
    report.headline = fmt::format(
        "Surroundings taken for half as stiff halve the result, within {:.0f} % (median)",
        groups.back().median_abs_error_percent);
    report.sentences = {fmt::format(
        "Without a measured force only ratios of stiffness can be found. The tissue "
        "round the organs truly has {:.0f} kPa, but {:.0f} kPa was assumed: half of the "
        "true stiffness is the right answer, and is called expected here.",
        true_kpa, assumed_kpa)};
    report.sections = {accuracy_section(ours, published, "expected E of the prostate, kPa"),
                       {"Recovered stiffness, kPa", surroundings_table(rows).html("beside"), {}}};
    report.facts = facts_of(groups);
    report.text = surroundings_table(rows).plain();
    return report;
}

}  // namespace

Study make_surroundings_study(const StudyOptions& options) {
    Study study{"surroundings",
                "Surrounding tissue of wrongly assumed stiffness",
                pelvis_settings(options),
                pelvis_columns(),
                {},
                surroundings_report};
    for (int scene = 0; scene < options.phantoms; ++scene)
        for (const double stiffness_kpa : {50, 100, 150, 200}) {
            PelvisCase work;
            work.truth =
                pelvis_options(options, options.first_seed + unsigned(scene), stiffness_kpa);
            work.truth.background_stiffness_kpa = true_kpa;
            work.expected_kpa = stiffness_kpa * assumed_kpa / true_kpa;
            work.assume = [](Settings& settings) {
                settings.background->stiffness_kpa = assumed_kpa;
            };
            study.cases.push_back(study_case(work, options));
        }
    return study;
}

}  // namespace palpate
