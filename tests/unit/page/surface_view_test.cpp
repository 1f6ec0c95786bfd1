// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/page/surface_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/page/page.hpp"
#include "tests/unit/page/in_browser.hpp"
#include "tests/unit/page/shapes.hpp"

namespace palpate {
namespace {

using Json = nlohmann::json;

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

Json data_of(const std::string& html) {
    const std::string open = "<script type='application/json'>";
    const std::size_t begin = html.find(open) + open.size();
    return Json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

TEST(SurfaceViewer, HoldsStatesFieldsAndSurfaces) {
    const Json data = data_of(surface_viewer_html(stretched_box_view()));

    EXPECT_EQ(data["states"], (Json{"short", "long"}));
    EXPECT_EQ(data["fields"][1]["name"], "warmth");
    EXPECT_EQ(data["fields"][1]["left"], "warmth");
    EXPECT_EQ(data["fields"][1]["right"], "K");
    EXPECT_EQ(data["centre_mm"], (Json{1.0, 0.5, 0.5})) << "round both states";
    const Json& box = data["surfaces"][0];
    EXPECT_TRUE(box["displacement"][0].is_null());
    EXPECT_EQ(box["displacement"][1]["low"], 0.0);
    EXPECT_EQ(box["displacement"][1]["high"], 1.0);
    EXPECT_TRUE(box["values"][0].is_null());
    EXPECT_TRUE(box["values"][1][0].is_null());
    EXPECT_EQ(box["values"][1][1]["high"], 1.0);
    EXPECT_TRUE(box["outline"].is_null());
}

TEST(SurfaceViewer, SaysSoWhereItThinsAndKeepsBelowTheLimit) {
    SurfaceView view = stretched_box_view();
    EXPECT_FALSE(has(surface_viewer_html(view), "thinned"));
    view.most_triangles = 100;

    const std::string html = surface_viewer_html(view);

    EXPECT_TRUE(has(html, "thinned, from 192 to ")) << html.substr(0, 400);
    const std::string triangles = data_of(html)["surfaces"][0]["triangles"];
    EXPECT_LE(triangles.size(), 100u * 3 * 4 * 4 / 3 + 4);
    EXPECT_GT(triangles.size(), 200u);
}

TEST(SurfaceViewer, NamesCannotEndItsScript) {
    SurfaceView view = stretched_box_view();
    view.surfaces[0].name = "</script><b>";

    const std::string html = surface_viewer_html(view);

    EXPECT_FALSE(has(html, "</script><b>"));
    EXPECT_EQ(data_of(html)["surfaces"][0]["name"], "</script><b>");
}

TEST(SurfaceViewer, WithoutSurfacesThereIsNone) { EXPECT_EQ(surface_viewer_html({}), ""); }

TEST(RoundRanges, EndAtARoundNumberThatHoldsTheLargest) {
    EXPECT_EQ(round_ranges(7.3), (std::vector<double>{0.8, 1.6, 4, 8}));
    EXPECT_EQ(round_ranges(0.01).back(), 0.01);
    EXPECT_EQ(round_ranges(9.5).back(), 10);
    EXPECT_EQ(round_ranges(0), (std::vector<double>{1}));
    EXPECT_EQ(round_ranges(NAN), (std::vector<double>{1}));
}

TEST(QuantileOfSizes, LeavesOutWhatIsNotKnown) {
    EXPECT_EQ(quantile_of_sizes({-3, 1, NAN, 2}, 0.5), 2);
    EXPECT_EQ(quantile_of_sizes({-3, 1, NAN, 2}, 1), 3);
    EXPECT_EQ(quantile_of_sizes({NAN}, 0.5), 0);
}

class ViewerInBrowser : public PageInBrowser {
protected:
    static std::string page_of(const SurfaceView& view) {
        return page_html({.kind = "Test",
                          .version = "1",
                          .headline = "Box",
                          .main = section_html("box", "Box", surface_viewer_html(view)),
                          .scripts = surface_viewer_script() + "startPage(startSurfaceViewers);"});
    }
};

TEST_F(ViewerInBrowser, KeysTurnAndEnlargeTheSliderDeformsAndFieldsColour) {
    SurfaceView view = stretched_box_view();
    view.has_creases = true;
    const std::string page = opened(with_script(page_of(view), R"(
const canvas = document.querySelector(".stage canvas"), slider = document.querySelector("input[type=range]");
const press = async (key) => { canvas.dispatchEvent(new KeyboardEvent("keydown", { key })); await frame(); };
const choose = async (select, value) => {
  select.value = value;
  select.dispatchEvent(new Event("change"));
  await frame();
};
const [colour, range, outline] = document.querySelectorAll("select");
await choose(outline, "off");
tell("long", painted());
slider.value = 0;
slider.dispatchEvent(new Event("input"));
await frame();
tell("short", painted());
await press("+");
tell("near", painted());
await press("Home");
tell("home", painted());
for (let i = 0; i < 8; ++i) await press("ArrowLeft");
tell("turned", painted());
await press("Home");
document.querySelector(".deform button:last-of-type").click();
tell("colours", colours());
await choose(colour, 1);
tell("warmth", colours());
await choose(range, 0.5);
tell("narrow", colours());
await choose(outline, "wire");
tell("scale", document.querySelector(".ticks").textContent === "−0.5−0.2500.250.5" ? 1 : 0);
)"),
                                    with_webgl);

    EXPECT_EQ(first_tag(page).find("failed"), std::string::npos) << first_tag(page);
    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
    EXPECT_GT(told(page, "short"), 500);
    EXPECT_GT(told(page, "long"), 1.4 * told(page, "short"));
    EXPECT_GT(told(page, "near"), 1.2 * told(page, "short"));
    EXPECT_EQ(told(page, "home"), told(page, "short"));
    EXPECT_NE(told(page, "turned"), told(page, "short"));
    EXPECT_NE(told(page, "warmth"), told(page, "colours"));
    EXPECT_NE(told(page, "narrow"), told(page, "warmth"));
    EXPECT_EQ(told(page, "scale"), 1);
}

TEST_F(ViewerInBrowser, WithoutWebGlItSaysWhereElseToLook) {
    const std::string page = opened(page_of(stretched_box_view()), without_webgl);

    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
    EXPECT_TRUE(has(page, "cannot be turned here. See the table.</p>"));
}

}  // namespace
}  // namespace palpate
