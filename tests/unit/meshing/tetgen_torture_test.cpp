// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Surfaces on which TetGen 1.5.0 crashes, hangs or returns nothing without a word.
#include <gtest/gtest.h>

#include <chrono>
#include <limits>

#include "host/geometry/meshing/mesher.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/meshing/test_surfaces.hpp"
#include "tests/unit/meshing/test_volumes.hpp"

namespace palpate {
namespace {

struct Refusal {
    ErrorCode code = ErrorCode::internal;
    std::string message = "a mesh was returned";
    double seconds = 0;
};

Refusal refusal_of(const RegionSurface& surface, MesherOptions options = {}) {
    const RegionImage image = testing::plain_image();
    const LabelField field(image, 2);
    options.kind = MesherKind::tetgen;
    Refusal refusal;
    const auto start = std::chrono::steady_clock::now();
    try {
        make_mesh(surface, image, field, {}, options);
    } catch (const Error& error) {
        refusal.code = error.code();
        refusal.message = error.what();
    }
    refusal.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return refusal;
}

RegionSurface ball() {
    RegionSurface surface;
    testing::add_sphere(surface, {20, 20, 20}, 15, 2, 1, outside_region);
    return surface;
}

void expect_refused(const RegionSurface& surface, const std::string& word) {
    MesherOptions options;
    options.time_limit_s = 10;
    const Refusal refusal = refusal_of(surface, options);
    EXPECT_EQ(refusal.code, ErrorCode::mesh_failed) << refusal.message;
    EXPECT_NE(refusal.message.find(word), std::string::npos) << refusal.message;
    EXPECT_LT(refusal.seconds, 25);
}

TEST(TetgenTorture, spheres_that_cross_are_refused) {
    RegionSurface surface;
    testing::add_box(surface, Vec3::Zero(), Vec3::Constant(60), {4, 4, 4}, 1, outside_region);
    testing::add_sphere(surface, {25, 30, 30}, 12, 2, 2, 1);
    testing::add_sphere(surface, {37, 31, 29}, 12, 2, 3, 1);
#ifdef PALPATE_ADDRESS_SANITIZER  // TetGen crashes after it has said so, and the sanitizer speaks
                                  // last
    expect_refused(surface, "TetGen");
#else
    expect_refused(surface, "cross");
#endif
}

TEST(TetgenTorture, a_triangle_given_twice_is_refused) {
    RegionSurface surface = ball();
    surface.triangles.push_back(surface.triangles[7]);
    surface.regions.push_back(surface.regions[7]);
    surface.on_image_border.push_back(0);
    expect_refused(surface, "twice");
}

TEST(TetgenTorture, coordinates_that_are_not_finite_are_refused) {
    for (double bad : {std::numeric_limits<double>::quiet_NaN(),
                       std::numeric_limits<double>::infinity(), 1e300}) {
        RegionSurface surface = ball();
        surface.vertices[3].y() = bad;
        expect_refused(surface, "vertex 3");
    }
}

TEST(TetgenTorture, an_empty_surface_is_refused) { expect_refused({}, "empty"); }

TEST(TetgenTorture, an_open_surface_is_refused) {
    RegionSurface surface = ball();
    surface.triangles.pop_back();
    surface.regions.pop_back();
    surface.on_image_border.pop_back();
    expect_refused(surface, "open");
}

TEST(TetgenTorture, a_vertex_number_out_of_range_is_refused) {
    for (Index bad : {-1, 100000, std::numeric_limits<Index>::max()}) {
        RegionSurface surface = ball();
        surface.triangles[5][1] = bad;
        expect_refused(surface, "triangle 5");
    }
}

TEST(TetgenTorture, a_region_number_out_of_range_is_refused) {
    RegionSurface surface = ball();
    surface.regions[4] = {-3, 0};
    expect_refused(surface, "region");
}

TEST(TetgenTorture, a_surface_inside_out_is_refused) {
    RegionSurface surface = ball();
    for (auto& triangle : surface.triangles) std::swap(triangle[0], triangle[1]);
    expect_refused(surface, "inside out");
}

TEST(TetgenTorture, a_triangle_without_area_is_refused) {
    RegionSurface surface = ball();
    surface.triangles[6][0] = surface.triangles[6][1];
    expect_refused(surface, "no area");
}

TEST(TetgenTorture, two_vertices_in_one_place_are_refused) {
    RegionSurface surface = ball();
    surface.vertices.push_back(surface.vertices[0]);
    expect_refused(surface, "same place");
}

TEST(TetgenTorture, a_flat_spike_never_hangs) {
    RegionSurface surface = ball();
    surface.vertices[0] = Vec3(20, 20, 20) + 1.0001 * (surface.vertices[1] - Vec3(20, 20, 20));
    MesherOptions options;
    options.time_limit_s = 5;
    EXPECT_LT(refusal_of(surface, options).seconds, 20);
}

TEST(TetgenTorture, the_time_limit_ends_a_mesh_that_is_too_large) {
    MesherOptions options;
    options.num_nodes = 20'000'000;
    options.time_limit_s = 0.1;
    const Refusal refusal = refusal_of(ball(), options);
    EXPECT_EQ(refusal.code, ErrorCode::time_limit) << refusal.message;
    EXPECT_LT(refusal.seconds, 5);
}

#ifndef PALPATE_ADDRESS_SANITIZER
TEST(TetgenTorture, the_memory_limit_is_an_error_and_not_a_crash) {
    MesherOptions options;
    options.num_nodes = 20'000'000;
    options.memory_limit_gib = 0.012;  // too little for any mesh at all
    options.time_limit_s = 30;
    EXPECT_EQ(refusal_of(ball(), options).code, ErrorCode::mesh_failed);
}
#endif

}  // namespace
}  // namespace palpate
