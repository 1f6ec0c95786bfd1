// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "host/cohort/collect.hpp"
#include "host/page/figure_html.hpp"
#include "host/page/interval_chart.hpp"
#include "host/page/markup.hpp"
#include "host/page/numbers.hpp"
#include "host/page/page.hpp"
#include "host/system/version.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_charts = 60;

std::string counts_table(const CohortStatus& status) {
    std::string rows;
    const auto row = [&](const std::string& name, std::size_t count) {
        rows +=
            fmt::format("<tr><th>{}</th><td class='num'>{}</td></tr>", escape_html(name), count);
    };
    for (const CaseStatus one : {CaseStatus::done, CaseStatus::not_converged, CaseStatus::failed,
                                 CaseStatus::stale, CaseStatus::waiting})
        row(name_of(one), status.count(one));
    for (const auto& [reason, times] : status.excluded_for) row("excluded: " + reason, times);
    if (status.bad_rows_left_out > 0)
        row("bad rows left out of the plan", status.bad_rows_left_out);
    std::string notes;
    for (const auto& [sentence, times] : status.failed_with)
        notes +=
            fmt::format("<p class='notice'>Failed, {} times: {}</p>", times, escape_html(sentence));
    return "<div class='scroll'><table class='narrow'><tbody>" + rows + "</tbody></table></div>" +
           notes;
}

std::string name_of_patient(const PatientRegion& region) {
    std::string name = region.patient->participant_id;
    if (region.patient->reference_name != "ref-01") name += ", " + region.patient->reference_name;
    return name;
}

/// Every pair with its interval; those without a modulus pale.
std::string chart_of_patient(const PatientRegion& region) {
    std::vector<IntervalBar> bars;
    for (const auto& [target, found] : region.found) {
        if (!(found.e_low_kpa > 0) || !(found.e_high_kpa > 0)) continue;
        const bool is_known = std::isfinite(found.e_kpa);
        bars.push_back({target,
                        is_known ? found.e_kpa : std::sqrt(found.e_low_kpa * found.e_high_kpa),
                        std::pair{found.e_low_kpa, found.e_high_kpa},
                        is_known ? "var(--accent)" : "var(--line)"});
    }
    if (bars.empty()) return "";
    const std::string name = fmt::format("{}: {}", name_of_patient(region), region.region);
    return fmt::format(
        "<figure>{}<figcaption>{}. Pale: not identifiable from that pair alone.</figcaption>"
        "</figure>",
        interval_chart(bars, "Young's modulus E, kPa", name + ", 95 % intervals by target"),
        escape_html(name));
}

std::string patients_table(const std::vector<PatientRegion>& regions) {
    std::string out =
        "<div class='scroll'><table><thead><tr><th>Participant</th><th>Region</th>"
        "<th class='num'>Pairs</th><th class='num'>Identified</th><th class='num'>Mean, kPa</th>"
        "<th class='num'>sd, kPa</th><th class='num'>Median, kPa</th></tr></thead><tbody>";
    const auto cell = [](double value) {
        return fmt::format("<td class='num'>{}</td>",
                           std::isfinite(value) ? significant(value) : "–");
    };
    for (const PatientRegion& region : regions) {
        const std::vector<double> kpa = region.identified_kpa();
        const PlainStatistics plain = plain_statistics(kpa);
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td class='num'>{}</td><td class='num'>{}</td>{}{}{}</tr>",
            escape_html(name_of_patient(region)), escape_html(region.region), region.pairs,
            kpa.size(), cell(plain.mean), cell(plain.sd), cell(plain.median));
    }
    return out + "</tbody></table></div>";
}

}  // namespace

std::string cohort_page(const CohortStatus& status, const std::vector<PatientRegion>& regions) {
    const std::size_t with_result =
        status.count(CaseStatus::done) + status.count(CaseStatus::not_converged);
    std::size_t cases = 0;
    for (const std::size_t count : status.counts) cases += count;
    std::string charts;
    std::size_t shown = 0;
    for (const PatientRegion& region : regions)
        if (shown < most_charts) {
            const std::string chart = chart_of_patient(region);
            charts += chart;
            shown += !chart.empty();
        }
    if (regions.size() > most_charts)
        charts += fmt::format(
            "<p class='caption'>The first {} of {} patients and regions; all are "
            "in <code>pairs.tsv</code>.</p>",
            shown, regions.size());
    return page_html(
        {.kind = "Stiffness of a cohort",
         .version = version_text(),
         .headline = fmt::format("{} of {} pairs have a result", with_result, cases),
         .lead = fmt::format("<p class='summary'>{} patients. A point and its 95 % interval for "
                             "each pair of images.</p>",
                             status.patients),
         .main = section_html("counts", "Where the pairs are", counts_table(status)) +
                 section_html("patients", "Patients", patients_table(regions)) +
                 section_html("pairs", "Pairs by patient", charts),
         .footer = "Means are plain and over pairs whose modulus was identified: the errors of a "
                   "patient's pairs are not independent, as they share a reference."});
}

}  // namespace palpate
