// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>

#include "host/geometry/meshing/mesher.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/meshing/test_surfaces.hpp"
#include "tests/unit/meshing/test_volumes.hpp"

namespace palpate {
namespace {

bool has_both_meshers() { return available_meshers().size() == 2; }

ErrorCode code_of(const MesherOptions& options, std::string* message = nullptr) {
    const RegionImage image = testing::plain_image();
    try {
        make_mesh(testing::touching_boxes({1}, 4, 40), image, LabelField(image, 2), {}, options);
    } catch (const Error& error) {
        if (message) *message = error.what();
        return error.code();
    }
    return ErrorCode::internal;
}

TEST(Mesher, uses_cgal_where_tetgen_fails_and_says_why) {
    if (!has_both_meshers()) GTEST_SKIP() << "palpate-mesh was built with one mesher only";
    RegionSurface open;
    testing::add_sphere(open, {30, 30, 30}, 12, 1, 2, 1);
    open.triangles.pop_back();
    open.regions.pop_back();
    open.on_image_border.pop_back();
    const RegionImage image = testing::ball_image(60, 2, {{{30, 30, 30}, 12, 2}});
    MesherOptions options;
    options.num_nodes = 1500;
    options.edge_length_mm = 5;
    MesherSummary summary;
    make_mesh(open, image, LabelField(image, 3), {}, options, &summary);
    EXPECT_EQ(summary.mesher.rfind("CGAL", 0), 0u) << summary.mesher;
    EXPECT_NE(summary.fallback.find("TetGen: "), std::string::npos) << summary.fallback;
    EXPECT_NE(summary.fallback.find("open"), std::string::npos) << summary.fallback;
}

TEST(Mesher, prefers_tetgen) {
    if (!has_both_meshers()) GTEST_SKIP() << "palpate-mesh was built with one mesher only";
    const RegionImage image = testing::plain_image();
    MesherSummary summary;
    int reports = 0;
    make_mesh(testing::touching_boxes({1}, 4, 40), image, LabelField(image, 2), {}, {}, &summary,
              [&](const Progress& progress) { reports += progress.stage == "meshing"; });
    EXPECT_EQ(summary.mesher.rfind("TetGen", 0), 0u) << summary.mesher;
    EXPECT_EQ(summary.fallback, "");
    EXPECT_GT(reports, 0);
    EXPECT_GT(summary.seconds, 0);
}

TEST(Mesher, says_how_to_get_a_program_that_is_missing) {
    MesherOptions options;
    options.program = "/nowhere/palpate-mesh";
    std::string message;
    EXPECT_EQ(code_of(options, &message), ErrorCode::mesh_failed);
    EXPECT_NE(message.find("/nowhere/palpate-mesh"), std::string::npos);
    EXPECT_TRUE(available_meshers(options.program).empty());
}

TEST(Mesher, refuses_a_program_that_is_something_else) {
    MesherOptions options;
    options.program = "/bin/true";  // ends well but writes no reply
    EXPECT_EQ(code_of(options), ErrorCode::mesh_failed);
}

TEST(Mesher, finds_the_program_that_the_environment_names) {
    setenv("PALPATE_MESH", "/nowhere/other", 1);
    std::string message;
    EXPECT_EQ(code_of({}, &message), ErrorCode::mesh_failed);
    unsetenv("PALPATE_MESH");
    EXPECT_NE(message.find("/nowhere/other"), std::string::npos);
}

TEST(Mesher, refuses_options_out_of_range) {
    MesherOptions options;
    options.num_nodes = 0;
    EXPECT_EQ(code_of(options), ErrorCode::invalid_argument);
    options = {};
    options.outer_edge_length_mm = 1;
    EXPECT_EQ(code_of(options), ErrorCode::invalid_argument);
}

TEST(Mesher, is_cancelled_by_the_progress_sink) {
    const RegionImage image = testing::plain_image();
    EXPECT_THROW(
        make_mesh(testing::touching_boxes({1}, 4, 40), image, LabelField(image, 2), {}, {}, nullptr,
                  [](const Progress&) { throw Error(ErrorCode::invalid_argument, "cancelled"); }),
        Error);
}

}  // namespace
}  // namespace palpate
