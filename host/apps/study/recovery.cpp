// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "host/apps/study/beside.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/apps/study/tables.hpp"
#include "host/page/numbers.hpp"

namespace palpate {
namespace {

/// One line per true stiffness, one column per scene, ours and the published ones.
StudyTable beside_table(const std::vector<Row>& rows) {
    BesideTable table("true E, kPa");
    for (const Row& row : rows)
        table.add(row.number("true_kpa"), "palpate, seed " + row.text("seed"),
                  significant(row.number("found_kpa")));
    for (const auto& value : published_recovery())
        table.add(value.expected_kpa, "published, " + value.scene, significant(value.found_kpa));
    return table.table();
}

StudyReport report_of(const std::vector<Row>& rows) {
    const auto ours = estimates_of(rows);
    const auto published = estimates_of(published_recovery());
    const auto groups = accuracy_by_group(ours), theirs = accuracy_by_group(published);

    StudyReport report;
    report.headline =
        fmt::format("50 to 350 kPa: median error {:.0f} % here, {:.0f} % published",
                    groups.back().median_abs_error_percent, theirs.back().median_abs_error_percent);
    report.sentences = {
        "The same pelvis with seven stiffnesses of its prostate, for each scene, recovered from "
        "two label volumes with linear elements; beside it the published recovery from two "
        "synthetic scenes."};
    report.sections = {accuracy_section(ours, published, "true E of the prostate, kPa"),
                       {"Recovered stiffness, kPa", beside_table(rows).html("beside"), {}}};
    report.facts = facts_of(groups);
    report.text = beside_table(rows).plain();
    return report;
}

}  // namespace

Study make_recovery_study(const StudyOptions& options) {
    Study study{"recovery",
                "Recovered stiffness beside published values",
                pelvis_settings(options),
                pelvis_columns(),
                {},
                report_of};
    for (int scene = 0; scene < options.phantoms; ++scene)
        for (const double stiffness_kpa : {50, 100, 150, 200, 250, 300, 350}) {
            PelvisCase work;
            work.truth =
                pelvis_options(options, options.first_seed + unsigned(scene), stiffness_kpa);
            study.cases.push_back(study_case(work, options));
        }
    return study;
}

}  // namespace palpate
