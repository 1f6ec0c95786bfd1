// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <cstdlib>

#include "host/apps/recover/report/html_report.hpp"
#include "tests/unit/report/synthetic_result.hpp"
#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {
namespace {

class ReportInBrowser : public TemporaryFolderTest {
protected:
    void SetUp() override {
        TemporaryFolderTest::SetUp();
        if (std::system("command -v chromium > /dev/null 2>&1") != 0)
            GTEST_SKIP() << "chromium is not installed, so the page cannot be opened";
    }

    /// The page as it is after its scripts have run.
    std::string opened(const RecoveryResult& result, const std::string& flags,
                       const GreyImages& images = {}) {
        const std::filesystem::path page = folder / "report.html";
        std::ofstream(page) << html_report(result, false, images);
        const std::string command = "HOME='" + folder.string() +
                                    "' timeout 100 chromium --headless --no-sandbox --disable-gpu "
                                    "--disable-dev-shm-usage --virtual-time-budget=5000 " +
                                    flags + " --dump-dom 'file://" + page.string() +
                                    "' 2> /dev/null";
        std::string text;
        std::FILE* pipe = ::popen(command.c_str(), "r");
        std::array<char, 65536> block;
        while (const std::size_t n = std::fread(block.data(), 1, block.size(), pipe))
            text.append(block.data(), n);
        ::pclose(pipe);
        return text;
    }
    static std::string first_tag(const std::string& page) {
        const std::size_t at = page.find("<html");
        return at == std::string::npos ? "no page" : page.substr(at, page.find('>', at) - at);
    }
};

constexpr const char* with_webgl = "--use-angle=swiftshader --enable-unsafe-swiftshader";
constexpr const char* without_webgl = "--disable-3d-apis";

TEST_F(ReportInBrowser, StartsBothViewersWithoutAnyScriptError) {
    const std::string page = opened(synthetic_result(), with_webgl);

    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
    EXPECT_EQ(first_tag(page).find("data-error"), std::string::npos) << first_tag(page);
    EXPECT_NE(page.find("slice 16 / 38"), std::string::npos);
}

TEST_F(ReportInBrowser, SaysSoWhereWebGlIsMissingAndKeepsTheSlices) {
    const std::string page = opened(synthetic_result(), without_webgl);

    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
    EXPECT_NE(first_tag(page).find("data-webgl=\"no\""), std::string::npos) << first_tag(page);
    EXPECT_NE(page.find("id=\"no-webgl\">"), std::string::npos) << "the message is still hidden";
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
