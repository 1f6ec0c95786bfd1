// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/cohort/cohort_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "host/page/figure_html.hpp"
#include "host/page/legend.hpp"
#include "host/page/markup.hpp"
#include "host/page/numbers.hpp"
#include "host/page/page.hpp"
#include "host/system/version.hpp"

namespace palpate {
namespace {

constexpr std::size_t patients_a_page = 100;  // patients and regions
constexpr std::size_t fewest_for_medians = 20, most_sentences = 12;

constexpr const char* page_style =
    ".flow td:nth-child(3){width:40%} .flow i{display:block;height:.7rem;background:var(--line);"
    "border-radius:2px} .flow .in i{background:var(--accent)} .plot a:hover circle{stroke:"
    "var(--ink);stroke-width:1.5} .doors{display:flex;flex-wrap:wrap;gap:.5rem 1.4rem}"
    ".doors .first{font-weight:600}.legend i{display:inline-block;width:.7rem;height:.7rem;"
    "border-radius:50%;margin-right:.4rem}.legend i.hollow{border:2px solid}";

std::string counts_table(const CohortStatus& status) {
    std::string rows;
    const auto row = [&](const std::string& name, std::size_t count) {
        rows += fmt::format("<tr><th>{}</th><td class='num'>{}</td></tr>", escape_html(name),
                            grouped(count));
    };
    for (const CaseStatus one : {CaseStatus::done, CaseStatus::not_converged, CaseStatus::failed,
                                 CaseStatus::stale, CaseStatus::waiting, CaseStatus::excluded})
        row(name_of(one), status.count(one));
    if (status.bad_rows_left_out > 0)
        row("bad rows left out of the plan", status.bad_rows_left_out);
    return "<div class='scroll'><table class='narrow'><tbody>" + rows + "</tbody></table></div>";
}

/// The commonest sentences with which cases failed.
std::string failures_html(const CohortStatus& status) {
    std::vector<std::pair<std::size_t, std::string>> sorted;
    for (const auto& [sentence, times] : status.failed_with) sorted.emplace_back(times, sentence);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::string notes;
    for (std::size_t k = 0; k < std::min(sorted.size(), most_sentences); ++k)
        notes += fmt::format("<p class='notice'>Failed, {} times: {}</p>", grouped(sorted[k].first),
                             escape_html(sorted[k].second));
    if (sorted.size() > most_sentences)
        notes +=
            fmt::format("<p class='caption'>And {} further sentences: <code>pairs.tsv</code>.</p>",
                        sorted.size() - most_sentences);
    return notes;
}

std::string flow_table(const ExclusionFlow& flow, std::size_t bad_rows) {
    const std::size_t all = flow.all() + bad_rows;
    std::size_t left = all;
    std::string rows;
    const auto row = [&](const char* kind, const std::string& name, std::size_t count,
                         const std::string& sign) {
        rows += fmt::format(
            "<tr class='{}'><th>{}</th><td class='num'>{}{}</td><td><i style='width:{:.1f}%'></i>"
            "</td></tr>",
            kind, escape_html(name), sign, grouped(count),
            all > 0 ? 100.0 * double(left) / all : 0.0);
    };
    const auto without = [&](const std::string& name, std::size_t count) {
        left -= count;
        if (count > 0) row("", name, count, "− ");
    };
    row("in", "pairs in the table", all, "");
    without("bad rows left out of the plan", bad_rows);
    for (const auto& [reason, count] : flow.reasons()) without(reason, count);
    row("in", "pairs in the means", flow.taken(), "= ");
    return "<div class='scroll'><table class='flow'><tbody>" + rows + "</tbody></table></div>";
}

std::string flags_table(const Gallery& gallery) {
    std::string rows;
    const std::vector<std::size_t> counts = gallery.flag_counts();
    for (std::size_t k = 0; k < counts.size(); ++k)
        if (counts[k] > 0)
            rows += fmt::format(
                "<tr><th><a href='gallery.html#flag-{}'>{}</a></th><td class='num'>{}</td></tr>", k,
                escape_html(name_of(static_cast<CaseFlag>(k))), grouped(counts[k]));
    if (rows.empty()) return "<p>No case has a flag.</p>";
    return "<div class='scroll'><table class='narrow'><tbody>" + rows + "</tbody></table></div>";
}

std::string patients_table(std::span<const PatientRegion> regions,
                           std::span<const PatientStrip> strips) {
    std::string out =
        "<div class='scroll'><table><thead><tr><th>Participant</th><th>Region</th>"
        "<th class='num'>Pairs</th><th class='num'>In the mean</th><th class='num'>Mean, kPa</th>"
        "<th class='num'>sd, kPa</th><th class='num'>Median, kPa</th></tr></thead><tbody>";
    const auto cell = [](double value) {
        return fmt::format("<td class='num'>{}</td>",
                           std::isfinite(value) ? significant(value) : "–");
    };
    for (std::size_t k = 0; k < regions.size(); ++k)
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td class='num'>{}</td><td class='num'>{}</td>{}{}{}</tr>",
            escape_html(strips[k].patient), escape_html(regions[k].region), regions[k].pairs,
            regions[k].identified, cell(regions[k].kpa.mean), cell(regions[k].kpa.sd),
            cell(regions[k].kpa.median));
    return out + "</tbody></table></div>";
}

std::size_t num_pages(const CohortView& view) {
    return std::max<std::size_t>(1, (view.strips.size() + patients_a_page - 1) / patients_a_page);
}

std::string page_name(std::size_t page) { return fmt::format("patients-{:04}.html", page + 1); }

/// Links to the pages of patients round this one; `root`: the folder of the cohort as it is seen.
std::string doors_between(const CohortView& view, std::size_t page, const std::string& root) {
    const std::size_t pages = num_pages(view);
    if (pages == 1) return "";
    std::string out = "<p class='doors'>";
    const auto door = [&](std::size_t to, const std::string& text) {
        out += fmt::format("<a href='{}'>{}</a>",
                           root + (to == 0 ? "index.html#patients" : "gallery/" + page_name(to)),
                           text);
    };
    if (page > 0) door(0, "first patients");
    if (page > 1) door(page - 1, "before");
    out += fmt::format("<span>page {} of {}</span>", page + 1, pages);
    if (page + 1 < pages) door(page + 1, "next patients");
    if (page + 2 < pages) door(pages - 1, "last patients");
    return out + "</p>";
}

/// Chart and table of one page of patients; a chart a region, all on one axis.
std::string patients_html(const CohortView& view, const StripAxis& axis, std::size_t page,
                          const std::string& root) {
    const std::size_t first = page * patients_a_page;
    const std::size_t count = std::min(patients_a_page, view.strips.size() - first);
    const auto link = [&](std::size_t number) {
        return fmt::format("{}gallery.html#{}", root, view.gallery.place_of(number));
    };
    const std::span strips = std::span(view.strips).subspan(first, count);
    std::set<std::string> names;
    for (const PatientStrip& strip : strips)
        if (!strip.points.empty()) names.insert(strip.region);
    std::string out = doors_between(view, page, root);
    if (!names.empty())
        out += legend_html({{"recovered", "var(--accent)"},
                            {"weak", "var(--weak)"},
                            {"look at it first", "var(--bad)", true}});
    for (const std::string& name : names) {
        std::vector<PatientStrip> of_region;
        for (const PatientStrip& strip : strips)
            if (strip.region == name) of_region.push_back(strip);
        out += fmt::format("<figure><h3>{}</h3>{}</figure>", escape_html(name),
                           strips_svg(of_region, axis, link));
    }
    if (!names.empty())
        out +=
            "<p class='caption'>A point and its 95 % interval for each pair of images, a stroke "
            "at the patient's median, one axis for all patients. At the right: how many of the "
            "pairs have a modulus. A point leads to its card in the gallery.</p>";
    return out + patients_table(std::span(view.regions).subspan(first, count), strips);
}

std::string medians_html(const CohortView& view, const StripAxis& axis) {
    if (view.strips.size() < fewest_for_medians) return "";
    std::set<std::string> names;
    for (const PatientStrip& strip : view.strips)
        if (!strip.points.empty()) names.insert(strip.region);
    std::string out;
    for (const std::string& name : names)
        out += fmt::format("<figure><h3>{}</h3>{}</figure>", escape_html(name),
                           medians_svg(view.strips, axis, name));
    return out;
}

constexpr const char* note_on_means =
    "Means are plain and over the pairs that the flow leaves: the errors of a patient's pairs are "
    "not independent, as they share a reference.";

}  // namespace

std::size_t& ExclusionFlow::count_of(const std::string& reason) {
    for (auto& [known, count] : reasons_)
        if (known == reason) return count;
    reasons_.emplace_back(reason, 0);
    return reasons_.back().second;
}

std::size_t ExclusionFlow::all() const {
    return std::accumulate(reasons_.begin(), reasons_.end(), taken_,
                           [](std::size_t sum, const auto& one) { return sum + one.second; });
}

std::string cohort_page(const CohortView& view) {
    const CohortStatus& status = view.status;
    const std::size_t with_result =
        status.count(CaseStatus::done) + status.count(CaseStatus::not_converged);
    const std::size_t cases =
        std::accumulate(status.counts.begin(), status.counts.end(), std::size_t{0});
    const StripAxis axis = strip_axis(view.strips);
    const std::string doors =
        "<p class='doors'><a class='first' href='gallery.html'>Gallery: every pair as a picture, "
        "the worst first</a><a href='pairs.tsv'>pairs.tsv</a><a href='patients.tsv'>patients.tsv"
        "</a></p>";
    return page_html(
        {.kind = "Stiffness of a cohort",
         .version = version_text(),
         .headline =
             fmt::format("{} of {} pairs have a result", grouped(with_result), grouped(cases)),
         .lead = fmt::format("<p class='summary'>{} patient{}.</p>{}", grouped(status.patients),
                             status.patients == 1 ? "" : "s", doors),
         .main = section_html("counts", "Where the pairs are",
                              "<div class='columns'><div>" +
                                  flow_table(view.flow, status.bad_rows_left_out) + "</div><div>" +
                                  counts_table(status) + "</div></div>" + failures_html(status)) +
                 section_html("flags", "What to look at first", flags_table(view.gallery)) +
                 section_html("medians", "Medians of the patients", medians_html(view, axis)) +
                 section_html("patients", "Patients", patients_html(view, axis, 0, "")),
         .footer = note_on_means,
         .style = page_style});
}

std::vector<std::pair<std::string, std::string>> patient_pages(const CohortView& view) {
    std::vector<std::pair<std::string, std::string>> pages;
    const StripAxis axis = strip_axis(view.strips);
    for (std::size_t page = 1; page < num_pages(view); ++page)
        pages.emplace_back(
            page_name(page),
            page_html(
                {.kind = "Patients of a cohort",
                 .version = version_text(),
                 .headline = fmt::format("Patients, page {} of {}", page + 1, num_pages(view)),
                 .lead = "<p class='doors'><a href='../index.html'>Page of the cohort</a>"
                         "<a href='../gallery.html'>Gallery</a></p>",
                 .main =
                     section_html("patients", "Patients", patients_html(view, axis, page, "../")),
                 .footer = note_on_means,
                 .style = page_style}));
    return pages;
}

}  // namespace palpate
