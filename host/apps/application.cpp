// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/application.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "host/io/output_folder.hpp"
#include "host/page/markup.hpp"
#include "host/page/page.hpp"
#include "host/page/tree_html.hpp"
#include "host/page/tree_json.hpp"
#include "host/system/version.hpp"

namespace palpate {

namespace {

constexpr const char* result_file = "result.json";

const std::vector<Option>& common_options() {
    static const std::vector<Option> options = {
        Option::folder("out", "Result folder, made new: result.json and report.html"),
        Option::flag("overwrite", "Replace an older result folder"),
        Option::number("time_limit", "s", {0, 1e7},
                       "Seconds after which the work ends with exit code 9; 0: none")
            .usually(0.0),
    };
    return options;
}

/// Names, values and units of what was given, as rows.
std::string given_rows(const Application& application, const OptionValues& values) {
    std::string rows;
    for (const Option& option : application.options) {
        auto value = values.setting(option.name);
        if (auto* path = value && option.kind >= OptionKind::input_file
                             ? std::get_if<std::string>(&*value)
                             : nullptr)
            *path = std::filesystem::path(*path).filename().string();  // folders name people
        if (value)
            rows += fmt::format("<tr><th>{}</th><td>{} {}</td></tr>", escape_html(option.name),
                                escape_html(setting_text(*value)), escape_html(option.unit));
    }
    return rows;
}

std::string pictures_html(const std::vector<Picture>& pictures) {
    std::string html;
    for (const Picture& picture : pictures)
        html += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>", picture.html,
                            escape_html(picture.caption));
    return html.empty() ? html : "<section><div class='figures'>" + html + "</div></section>";
}

std::string report_of(const Application& application, const OptionValues& values,
                      const Outcome& outcome) {
    const ResultTree& result = outcome.result;
    const std::string given = "<div class='scroll'><table class='narrow'><tbody>" +
                              given_rows(application, values) + "</tbody></table></div>";
    return page_html({.kind = "palpate " + application.name,
                      .version = version_text(),
                      .headline = escape_html(result.title),
                      .lead = "<p class='summary'>" + escape_html(application.summary) + ".</p>",
                      .main = tree_sections_html(result, pictures_html(outcome.pictures)) +
                              section_html("given", "What was given", given),
                      .footer = "The same figures for programs: <code>result.json</code>."});
}

}  // namespace

std::vector<Option> all_options(const Application& application) {
    std::vector<Option> options = application.options;
    for (const Option& option : common_options())
        if (!find_option(options, option.name) &&
            !(application.writes_its_folder() && option.name == "overwrite"))
            options.push_back(option);
    return options;
}

Outcome run_application(const Application& application, const OptionValues& values, LimitEnds ends,
                        const ProgressSink& progress) {
    const std::filesystem::path folder = values.path("out");
    const bool writes = !application.writes_its_folder() && !folder.empty();
    if (writes) check_output_folder(folder, result_file, values.flag("overwrite"));
    const TimeLimit limit(values.number("time_limit"), ends);
    const ProgressSink watched = limit.watched(progress);
    Outcome outcome = application.run(values, watched);
    if (!writes) return outcome;
    report_progress(watched, "writing", 0, "result folder");
    write_folder_atomically(folder, values.flag("overwrite"), [&](const auto& inside) {
        write_text_file(inside / result_file, tree_json(outcome.result));
        write_text_file(inside / "report.html", report_of(application, values, outcome));
        for (const auto& [name, text] : outcome.files) write_text_file(inside / name, text);
    });
    return outcome;
}

}  // namespace palpate
