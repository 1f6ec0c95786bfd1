// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/apps/simulate/body_view.hpp"
#include "host/apps/simulate/simulation_page.hpp"
#include "tests/unit/page/in_browser.hpp"
#include "tests/unit/page/shapes.hpp"
#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

const std::string pulled_top = "[[move]]\nname = \"top\"\nwhere = {side = \"z-max\"}\nz_mm = 0.5\n";
const std::string ball =
    "[[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\nplace_mm = [2, 2, 9]\nradius_mm = 2\n";

SimulationResult result_of(const std::string& toml) { return run_simulation(parsed(toml)); }

/// A block of 3 x 3 x 3 cells whose middle one is another region.
std::string block_with_core() {
    return "[mesh]\nbox = {size_mm = [6, 6, 6], divisions = [3, 3, 3]}\n"
           "[[mesh.part]]\nregion = 2\nwhere = {from_mm = [2, 2, 2], to_mm = [4, 4, 4]}\n"
           "[[material]]\nregion = 1\nlaw = \"neo-hookean\"\nstiffness_kpa = 10\npoisson_ratio = "
           "0.3\n[[material]]\nregion = 2\nlaw = \"neo-hookean\"\nstiffness_kpa = "
           "50\npoisson_ratio = 0.3\n" +
           held_base + pulled_top;
}

TEST(BodyView, HasTheSurfaceWithAllFieldsInAllStates) {
    const SimulationResult result =
        result_of(box_mesh + one_material + held_base + pulled_top + "[newton]\nload_steps = 2\n");

    const SurfaceView view = body_view(result);

    EXPECT_EQ(view.states,
              (std::vector<std::string>{"at rest", "at 50.0 % of the load", "at full load"}));
    EXPECT_EQ(view.first, 2u);
    ASSERT_EQ(view.surfaces.size(), 1u);
    const SurfaceInView& body = view.surfaces[0];
    EXPECT_NEAR(area_of(body.shape), 2 * (16 + 8 + 8), 1e-9);
    ASSERT_EQ(body.displacement.size(), 3u);
    ASSERT_EQ(body.values.size(), view.fields.size());
    double highest = 0;
    for (const Vec3& u : body.displacement[2]) highest = std::max(highest, u.z());
    EXPECT_DOUBLE_EQ(highest, 0.5);
    for (std::size_t f = 1; f < body.values.size(); ++f) {
        EXPECT_TRUE(body.values[f][0].empty());
        EXPECT_EQ(body.values[f][2].size(), body.shape.vertices.size());
    }
}

TEST(BodyView, ARegionInsideAnotherIsDrawnOnceAndKnownToBeInside) {
    const SurfaceView view = body_view(result_of(block_with_core()));

    ASSERT_EQ(view.surfaces.size(), 2u);
    EXPECT_NEAR(area_of(view.surfaces[0].shape), 6 * 36, 1e-9);
    EXPECT_NEAR(area_of(view.surfaces[1].shape), 6 * 4, 1e-9);
    EXPECT_FALSE(view.surfaces[0].is_inside);
    EXPECT_TRUE(view.surfaces[1].is_inside);
}

TEST(BodyView, AboutAnAxisThereAreBothHalves) {
    const SurfaceView view = body_view(result_of(
        "[mesh]\nformulation = \"axisymmetric\"\nrectangle = {size_mm = [4, 2], divisions = [4, "
        "2]}\n" +
        one_material +
        "[[fix]]\nwhere = {side = \"y-min\"}\n[[move]]\nwhere = {side = \"y-max\"}\ny_mm = "
        "0.2\n"));

    const TriangleShape& body = view.surfaces.at(0).shape;
    EXPECT_NEAR(area_of(body), 2 * 8, 1e-9);
    double left = 0;
    for (const Vec3& x : body.vertices) left = std::min(left, x.x());
    EXPECT_EQ(left, -4);
}

TEST(BodyView, ObstaclesAreGlassWithTheirRadius) {
    const SurfaceView view = body_view(result_of(box_mesh + one_material + held_base + ball));

    ASSERT_EQ(view.surfaces.size(), 2u);
    EXPECT_TRUE(view.surfaces[1].is_glass);
    for (const Vec3& x : view.surfaces[1].shape.vertices)
        EXPECT_NEAR((x - Vec3(2, 2, 9)).norm(), 2, 1e-12);
}

TEST(BodyView, OfManyStatesSomeAreShownWithTheLast) {
    const SimulationResult result =
        result_of(box_mesh + one_material + held_base + pulled_top + "[newton]\nload_steps = 50\n");

    const SurfaceView view = body_view(result);

    EXPECT_EQ(view.states.size(), 21u);
    EXPECT_EQ(view.states.back(), "at full load");
    EXPECT_NE(view.note.find("21 of 51 states"), std::string::npos);
}

class SimulationInBrowser : public PageInBrowser {};

constexpr const char* paint_each_state = R"(
const slider = document.querySelector("input[type=range]"), colour = document.querySelector("select");
tell("body", painted());
tell("moved", colours());
slider.value = 0;
slider.dispatchEvent(new Event("input"));
await frame();
tell("rest", colours());
slider.value = slider.max;
slider.dispatchEvent(new Event("input"));
for (const option of [...colour.options]) {
  colour.value = option.value;
  colour.dispatchEvent(new Event("change"));
  await frame();
  if (painted() < 500) throw new Error("nothing is drawn for " + option.textContent);
}
tell("fields", colour.options.length);
tell("stills", [...document.querySelectorAll(".still svg")].filter((s) => s.checkVisibility()).length);
)";

TEST_F(SimulationInBrowser, TheBodyIsDrawnInEveryStateAndField) {
    const std::string html = simulation_page(result_of(block_with_core() + ball));
    const std::string page = opened(with_script(html, paint_each_state), with_webgl);

    EXPECT_EQ(first_tag(page).find("failed"), std::string::npos) << first_tag(page);
    EXPECT_EQ(first_tag(page).find("data-error"), std::string::npos) << first_tag(page);
    EXPECT_NE(first_tag(page).find("data-webgl=\"yes\""), std::string::npos) << first_tag(page);
    EXPECT_GT(told(page, "body"), 1000);
    EXPECT_NE(told(page, "moved"), told(page, "rest"));
    EXPECT_EQ(told(page, "fields"), 8);
    EXPECT_EQ(told(page, "stills"), 0);
}

TEST_F(SimulationInBrowser, WithoutWebGlThePicturesStay) {
    const std::string html =
        simulation_page(result_of(box_mesh + one_material + held_base + pulled_top));
    const std::string page = opened(
        with_script(html,
                    "tell('stills', [...document.querySelectorAll('.still svg')].filter((s) => "
                    "s.checkVisibility()).length);"),
        without_webgl);

    EXPECT_NE(first_tag(page).find("data-report=\"ready\""), std::string::npos) << first_tag(page);
    EXPECT_EQ(told(page, "stills"), 2);
    EXPECT_NE(page.find("The pictures below show them"), std::string::npos);
}

}  // namespace
}  // namespace palpate
