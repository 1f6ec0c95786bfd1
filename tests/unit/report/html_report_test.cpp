// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/html_report.hpp"

#include <gtest/gtest.h>

#include "host/apps/recover/report/findings.hpp"
#include "host/page/markup.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/report/holds.hpp"
#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

TEST(EscapeHtml, MakesMarkupAndBrokenTextHarmless) {
    EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
    EXPECT_EQ(escape_html("Blase \xc3\xa4 \xe2\x82\xac"), "Blase \xc3\xa4 \xe2\x82\xac");
    EXPECT_EQ(escape_html("a\x01z"), "a\xef\xbf\xbdz");
    EXPECT_EQ(escape_html("a\xffz"), "a\xef\xbf\xbdz");
    EXPECT_EQ(escape_html("cut \xe2\x82"), "cut \xef\xbf\xbd\xef\xbf\xbd");
    EXPECT_EQ(escape_html("\xc3<b>"), "\xef\xbf\xbd&lt;b&gt;");
    EXPECT_EQ(escape_html(std::string_view("a\0z", 3)), "a\xef\xbf\xbdz");
}

TEST(FillTemplate, ReplacesOnceAndRefusesWhatIsNotKnown) {
    EXPECT_EQ(fill_template("<{{a}}|{{b}}>", {{"a", "{{b}}"}, {"b", "2"}}), "<{{b}}|2>");
    EXPECT_THROW(fill_template("{{c}}", {{"a", "1"}}), Error);
    EXPECT_THROW(fill_template("{{a", {{"a", "1"}}), Error);
}

TEST(RegionColour, DiffersBetweenOrgansAndIsGreyForFixedOnes) {
    const RecoveryResult result = synthetic_result();

    EXPECT_NE(region_colour(result, 2), region_colour(result, 3));
    EXPECT_NE(region_colour(result, 4), region_colour(result, 5));
    EXPECT_EQ(region_colour(result, 6), region_colour(result, 1));
}

TEST(HtmlReport, HoldsTheAnswerTablesAndPlots) {
    const std::string page = html_report(synthetic_result());

    EXPECT_TRUE(holds(page, "83.2 <small>kPa</small>"));
    EXPECT_TRUE(holds(page, "61.4 – 113 kPa"));
    EXPECT_TRUE(holds(page, "<span class='chip weak'>weak</span>"));
    EXPECT_TRUE(holds(page, "0.860"));
    EXPECT_TRUE(holds(page, "1.92: 95 %"));
    EXPECT_TRUE(holds(page, "Objective over the iterations"));
    EXPECT_TRUE(holds(page, "<svg class='slice'"));
    EXPECT_TRUE(holds(page, "Not a medical device"));
    EXPECT_TRUE(holds(page, "tilted by up to 5.7°"));
    EXPECT_FALSE(holds(page, "{{"));
    EXPECT_FALSE(holds(page, "Not converged"));
}

TEST(HtmlReport, FetchesNothing) {
    const std::string page = html_report(synthetic_result());

    for (const char* part : {"http://", "https://", "src=", "@import", "url(h", "<link", "fetch("})
        EXPECT_FALSE(holds(page, part)) << part;
    EXPECT_TRUE(holds(page, "default-src 'none'"));
}

TEST(HtmlReport, EscapesEveryTextFromOutside) {
    RecoveryResult result = synthetic_result();
    const std::string evil = "</script><b class=\"evil\">&";
    for (RegionResult& r : result.regions) r.name = r.reason = evil;
    for (SurfaceResult& s : result.surfaces) s.name = evil;
    for (OrganSettings& o : result.settings.organs) o.name = evil;
    result.version = result.termination.reason = result.alignment.method = evil;
    result.device.backend = result.device.device = result.device.platform = evil;
    for (auto& [stage, solver] : result.linear_solvers)
        stage = solver.library = solver.reason = solver.device.device = evil;
    result.element_loops.emplace().reason = evil;
    result.mesher.mesher = result.mesher.fallback = result.seed_note = evil;
    result.reference_name = result.target_name = evil;
    result.warnings = {evil};
    result.timings_s = {{evil, 1.0}};
    result.termination.converged = false;

    const std::string page = html_report(result, true);

    EXPECT_FALSE(holds(page, "<b class"));
    EXPECT_TRUE(holds(page, "&lt;b class="));
    EXPECT_TRUE(holds(page, "Not converged"));
}

TEST(HtmlReport, TellsWhereElementLoopsRan) {
    RecoveryResult result = synthetic_result();
    EXPECT_FALSE(holds(html_report(result), "Element loops"));

    result.element_loops.emplace().device.device = "host";
    result.element_loops->reason = "a small mesh";
    EXPECT_TRUE(
        holds(html_report(result), "<dt>Element loops</dt><dd>on host (a small mesh)</dd>"));
}

TEST(HtmlReport, ShowsHowMuchEachCombinationOfModuliIsNarrowed) {
    const std::string page = html_report(synthetic_result());

    EXPECT_TRUE(holds(page,
                      "<td class='num'>2.40</td><td class='num'>38.5 %</td>"
                      "<td class='num'>0.24</td><td class='num'>0.97</td>"));
}

TEST(HtmlReport, ShowsPoissonRatiosThatWereSearched) {
    RecoveryResult result = synthetic_result();
    result.regions[0].poisson_ratio = 0.33;
    result.regions[0].ratio = RatioResult{{0.3, 0.36}, Verdict::recovered, "narrow & <nice>"};
    result.regions[1].ratio = RatioResult{{0.25, 0.49}, Verdict::not_identifiable, "wide"};

    const std::string page = html_report(result);

    EXPECT_TRUE(holds(page, "background, Poisson's ratio"));
    EXPECT_TRUE(holds(page, "<p class='value'>0.33</p><p>95 % interval 0.30 – 0.36</p>"));
    EXPECT_TRUE(holds(page, "0.33 (0.30 – 0.36)"));
    EXPECT_TRUE(holds(page, "narrow &amp; &lt;nice&gt;"));
    EXPECT_TRUE(holds(page, "prostate, transition zone, Poisson's ratio"));
}

TEST(HtmlReport, NamesInputFilesOnlyIfAsked) {
    const RecoveryResult result = synthetic_result();

    EXPECT_FALSE(holds(html_report(result), "SECRETPATIENT"));
    EXPECT_TRUE(holds(html_report(result, true), "SECRETPATIENT_reference.nii.gz"));
}

TEST(HtmlReport, NamesTheDisplacementFilesThatLieBesideIt) {
    const auto page = [](FieldChoice fields) {
        return html_report(synthetic_result(), false, {}, fields);
    };
    const std::string none = page(FieldChoice::none), one = page(FieldChoice::one),
                      all = page(FieldChoice::all);

    EXPECT_TRUE(holds(none, "<code>warped_labels.nii.gz</code>.</p>"));
    for (const FieldFile& f : {forward_field, backward_field}) {
        EXPECT_FALSE(holds(none, f.field));
        EXPECT_TRUE(holds(one, f.field));
        EXPECT_TRUE(holds(all, f.field));
        EXPECT_FALSE(holds(one, f.transform));
        EXPECT_TRUE(holds(all, f.transform));
    }
    EXPECT_TRUE(holds(one, "palpate export"));
    EXPECT_FALSE(holds(none + all, "palpate export"));
}

TEST(HtmlReport, WithoutAnUnknownModulusStillSaysWhatItIs) {
    RecoveryResult result = synthetic_result();
    for (RegionResult& r : result.regions) r.unknown = false;
    result.profiles.clear();
    result.convergence.clear();
    result.correlation.clear();
    result.sensitivity.clear();

    const std::string page = html_report(result);

    EXPECT_TRUE(holds(page, "no modulus was unknown"));
    EXPECT_FALSE(holds(page, "id='certainty'"));
}

}  // namespace
}  // namespace palpate
