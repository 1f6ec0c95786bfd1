// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/apps/study/assets.hpp"
#include "host/apps/study/study_folder.hpp"
#include "host/page/assets.hpp"
#include "host/page/markup.hpp"
#include "host/page/page.hpp"
#include "host/system/version.hpp"

namespace palpate {
namespace {

std::string paragraphs(const std::vector<std::string>& sentences) {
    std::string out;
    for (const std::string& text : sentences)
        out += fmt::format("<p class='summary'>{}</p>", escape_html(text));
    return out;
}

std::string notices(const StudyRun& run) {
    std::string out;
    if (run.rows.size() < run.num_cases)
        out += fmt::format(
            "<p class='notice'><b>Not complete.</b> {} of {} cases are done. The same command goes "
            "on where this one stopped.</p>",
            run.rows.size(), run.num_cases);
    for (const auto& [id, message] : run.failures)
        out += fmt::format("<p class='notice bad'><b>{} failed.</b> {}</p>", escape_html(id),
                           escape_html(message));
    return out;
}

std::string figures(const std::vector<StudyPicture>& pictures) {
    std::string out;
    for (const StudyPicture& picture : pictures)
        out += fmt::format("<figure>{}{}<figcaption>{}</figcaption></figure>", picture.legend,
                           picture.svg, escape_html(picture.caption));
    return out.empty() ? out : "<div class='figures'>" + out + "</div>";
}

std::string sections(const std::vector<StudySection>& all) {
    std::string out;
    for (const StudySection& section : all)
        out += fmt::format("<section><h2>{}</h2>{}{}</section>", escape_html(section.title),
                           figures(section.pictures), section.html);
    return out;
}

std::string cell(const std::string& value) {
    const bool is_number =
        !value.empty() && value.find_first_not_of("0123456789.-") == std::string::npos;
    return fmt::format("<td{}>{}</td>", is_number ? " class='num'" : "", escape_html(value));
}

bool is_number_column(const std::string& column, const std::vector<Row>& rows) {
    for (const Row& row : rows)
        if (row.has(column)) return cell(row.text(column)).find("class='num'") != std::string::npos;
    return false;
}

/// "true_kpa" -> "true, kPa".
std::string heading(std::string column) {
    for (const auto& [ending, unit] :
         {std::pair{"_kpa", ", kPa"}, {"_mm", ", mm"}, {"_percent", ", %"}}) {
        const std::size_t at = column.size() - std::min(column.size(), std::string(ending).size());
        if (column.substr(at) == ending) column.replace(at, std::string::npos, unit);
    }
    for (char& c : column)
        if (c == '_') c = ' ';
    return column;
}

/// Whether a column says nothing beside another: as expected where that is the truth.
bool repeats_truth(const std::string& column, const std::vector<Row>& rows) {
    return column == "expected_kpa" && std::all_of(rows.begin(), rows.end(), [](const Row& row) {
               return row.text("expected_kpa") == row.text("true_kpa");
           });
}

/// Every row; columns that hold long lists or repeat another are left to study.csv.
std::string cases_table(const Study& study, const std::vector<Row>& rows) {
    constexpr std::size_t longest_shown = 40;
    std::vector<std::string> shown;
    for (const std::string& column : study.columns) {
        bool is_short = true;
        for (const Row& row : rows) is_short &= row.text(column).size() <= longest_shown;
        if (is_short && !repeats_truth(column, rows)) shown.push_back(column);
    }
    std::string out = "<div class='scroll'><table class='cases'><thead><tr>";
    for (const std::string& column : shown)
        out += fmt::format("<th{}>{}</th>", is_number_column(column, rows) ? " class='num'" : "",
                           escape_html(heading(column)));
    out += "</tr></thead><tbody>";
    for (const Row& row : rows) {
        out += row.text("holds_truth") == "no" ? "<tr class='missed'>" : "<tr>";
        for (const std::string& column : shown) out += cell(row.text(column));
        out += "</tr>";
    }
    return out +
           "</tbody></table></div><p class='caption'>Rows in red: the 95 % interval misses the "
           "true value. The same numbers are in <code>study.csv</code>.</p>";
}

std::string settings_list(const Study& study) {
    std::string out = "<dl>";
    for (const auto& [name, value] : study.settings)
        out += fmt::format("<dt>{}</dt><dd>{}</dd>", escape_html(name), escape_html(value));
    return out + "</dl>";
}

}  // namespace

std::string study_page(const Study& study, const StudyRun& run, const StudyReport& report) {
    const std::string repeat = fmt::format(
        "{}<p class='caption'>Every case is made from its seed alone: <code>palpate study {} --out "
        "FOLDER</code> with these settings gives the same phantoms.</p>",
        settings_list(study), escape_html(study.name));
    return page_html(
        {.kind = study.title,
         .version = version_text(),
         .headline = escape_html(report.headline),
         .lead = paragraphs(report.sentences),
         .notices = notices(run),
         .main = sections(report.sections) +
                 section_html("cases", "All cases", cases_table(study, run.rows)) +
                 section_html("again", "How to make it again", repeat),
         .footer = "Moduli are Young's moduli in kPa, lengths in mm. Pictures: "
                   "<code>pictures/*.svg</code>; summary for programs: <code>study.json</code>.",
         .style = std::string(study_css())});
}

std::string standalone_svg(const std::string& svg) {
    const std::size_t head = svg.find("<svg"), end = svg.find('>');
    if (head != 0 || end == std::string::npos) return svg;
    return "<svg xmlns='http://www.w3.org/2000/svg'" + svg.substr(4, end - 3) +
           "<style>svg{font-family:system-ui,sans-serif}" + std::string(page_css()) +
           std::string(study_css()) + "</style>" + svg.substr(end + 1) + "\n";
}

void write_study_page(const Study& study, const StudyRun& run,
                      const std::filesystem::path& folder) {
    StudyReport report;
    report.headline = "No case is done yet";
    if (!run.rows.empty()) report = study.report(run.rows);
    std::filesystem::create_directories(folder / "pictures");
    for (const StudySection& section : report.sections)
        for (const StudyPicture& picture : section.pictures)
            replace_file(folder / "pictures" / (picture.name + ".svg"),
                         standalone_svg(picture.svg));
    replace_file(folder / "study.html", study_page(study, run, report));
    replace_file(folder / "study.json", study_json(study, report.facts));
}

}  // namespace palpate
