// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/html_report.hpp"
#include "tests/unit/page/in_browser.hpp"
#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

class ReportInBrowser : public PageInBrowser {
protected:
    std::string opened(const RecoveryResult& result, const std::string& flags,
                       const GreyImages& images = {}) {
        return PageInBrowser::opened(html_report(result, false, images), flags);
    }
};

TEST_F(ReportInBrowser, StartsBothViewersWithoutAnyScriptError) {
    const std::string page = opened(synthetic_result(), with_webgl);

    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
    EXPECT_EQ(first_tag(page).find("data-error"), std::string::npos) << first_tag(page);
    EXPECT_NE(page.find("slice 16 / 38"), std::string::npos);
}

TEST_F(ReportInBrowser, DrawsTheOrgansBeforeAndAfterInEveryColour) {
    const std::string page = PageInBrowser::opened(with_script(html_report(synthetic_result()), R"(
const colour = document.querySelector("select");
tell("choices", [...colour.options].map((option) => option.textContent).join());
let fewest = Infinity;
for (const option of [...colour.options]) {
  colour.value = option.value;
  colour.dispatchEvent(new Event("change"));
  await frame();
  fewest = Math.min(fewest, painted());
}
tell("fewest", fewest);
)"),
                                                   with_webgl);

    EXPECT_GT(told(page, "fewest"), 1000) << first_tag(page);
    EXPECT_NE(first_tag(page).find("distance to target,displacement,surface traction,organ"),
              std::string::npos)
        << first_tag(page);
}

TEST_F(ReportInBrowser, SaysSoWhereWebGlIsMissingAndKeepsTheSlices) {
    const std::string page = opened(synthetic_result(), without_webgl);

    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
    EXPECT_NE(first_tag(page).find("data-webgl=\"no\""), std::string::npos) << first_tag(page);
    EXPECT_NE(page.find("The slices below show the same outlines."), std::string::npos);
    EXPECT_NE(page.find("slice 16 / 38"), std::string::npos);
}

TEST_F(ReportInBrowser, UnpacksBothImagesAndOffersThem) {
    const RecoveryResult result = synthetic_result();
    Image<float> image{result.target_labels_aligned.grid, {}};
    for (const auto label : result.target_labels_aligned.voxels) image.voxels.push_back(label);

    const std::string page = opened(result, with_webgl, {&image, &image});

    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
    EXPECT_NE(first_tag(page).find("data-pictures=\"ready\""), std::string::npos)
        << first_tag(page);
    EXPECT_EQ(first_tag(page).find("data-error"), std::string::npos) << first_tag(page);
    EXPECT_NE(page.find("aria-pressed=\"true\">target image<"), std::string::npos);
    EXPECT_NE(page.find("aria-pressed=\"false\">reference image<"), std::string::npos);
}

TEST_F(ReportInBrowser, NamesFullOfMarkupRunNothing) {
    RecoveryResult result = synthetic_result();
    const std::string evil = "</script><img src=x onerror=\"document.title='hacked'\">";
    for (RegionResult& r : result.regions) r.name += evil;
    for (SurfaceResult& s : result.surfaces) s.name += evil;

    const std::string page = opened(result, with_webgl);

    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
    EXPECT_EQ(page.find("<img"), std::string::npos);
    EXPECT_EQ(page.find("<title>hacked"), std::string::npos);
}

TEST_F(ReportInBrowser, AnEmptyResultIsStillAPage) {
    const std::string page = opened(RecoveryResult{}, with_webgl);

    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
}

}  // namespace
}  // namespace palpate
