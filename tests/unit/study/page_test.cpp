// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/page.hpp"

#include <gtest/gtest.h>

#include "host/apps/study/published.hpp"
#include "host/apps/study/tables.hpp"

namespace palpate {
namespace {

Row row_of(const std::string& name, double truth, double found, bool holds) {
    Row row;
    row.set("case", name);
    row.set("true_kpa", truth, 1);
    row.set("found_kpa", found, 1);
    row.set("low_kpa", holds ? 0.8 * truth : 1.1 * truth, 1);
    row.set("high_kpa", 1.3 * truth, 1);
    row.set_flag("holds_truth", holds);
    row.set("verdict", std::string("recovered"));
    row.set("reason", std::string("narrow <b>"));
    return row;
}

Study study_of_two() {
    return {"two",
            "Two <cases>",
            {{"nodes", "6000"}},
            {"true_kpa", "found_kpa", "holds_truth", "verdict", "reason"},
            {},
            {}};
}

TEST(StudyPage, ShowsEveryCaseEscapedAndMarksTheOnesThatMiss) {
    StudyRun run;
    run.rows = {row_of("a", 50, 52, true), row_of("b", 100, 120, false)};
    run.num_cases = 3;
    run.failures = {{"c", "no mesh & no hope"}};
    StudyReport report;
    report.headline = "It works";
    report.sections = {accuracy_section(estimates_of(run.rows), estimates_of(published_recovery()),
                                        "true E, kPa")};

    const std::string page = study_page(study_of_two(), run, report);

    EXPECT_NE(page.find("<h1>It works</h1>"), std::string::npos);
    EXPECT_NE(page.find("<tr class='missed'><td class='num'>100.0</td>"), std::string::npos);
    EXPECT_NE(page.find("narrow &lt;b&gt;"), std::string::npos);
    EXPECT_NE(page.find("2 of 3 cases are done"), std::string::npos);
    EXPECT_NE(page.find("no mesh &amp; no hope"), std::string::npos);
    EXPECT_EQ(page.find("nan"), std::string::npos);
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("<img"), std::string::npos);
}

TEST(StudyPage, OfNothingIsStillAPage) {
    const std::string page = study_page(study_of_two(), {}, {});

    EXPECT_NE(page.find("</html>"), std::string::npos);
}

TEST(StudyTable, AlignsColumnsByCharactersNotBytes) {
    const StudyTable table{{"name", "value"}, {{"a", "–"}, {"long name", "12"}}};

    EXPECT_EQ(table.plain(), "name        value\na               –\nlong name      12\n");
}

}  // namespace
}  // namespace palpate
