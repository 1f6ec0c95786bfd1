// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/graded_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

GradedSettings under_a_tube() {
    GradedSettings graded;
    graded.width_mm = 20;
    graded.depth_mm = 16;
    graded.edge_mm = 5.2;
    return graded;
}

TEST(GradedMesh, FillsTheBodyAndIsFinestAtEdgeAndSurface) {
    const SolidMesh mesh = graded_mesh(under_a_tube(), Formulation::axisymmetric);

    EXPECT_EQ(mesh.num_elements(), 23 * 13);
    double volume = 0;
    for (const PointGeometry& point : point_geometry(mesh)) volume += point.volume;
    EXPECT_NEAR(volume, std::numbers::pi * 20 * 20 * 16, 1e-9 * volume);
    const auto has_node = [&](double x, double y) {
        return std::any_of(mesh.nodes.begin(), mesh.nodes.end(), [&](const Vec3& at) {
            return std::abs(at.x() - x) < 1e-12 && std::abs(at.y() - y) < 1e-12;
        });
    };
    EXPECT_TRUE(has_node(5.2, 0));
    EXPECT_TRUE(has_node(20, -0.25));
    double narrowest = 1e9;
    for (std::size_t k = 1; k <= 23; ++k)
        narrowest = std::min(narrowest, mesh.nodes[k].x() - mesh.nodes[k - 1].x());
    EXPECT_NEAR(mesh.nodes[14].x() - mesh.nodes[13].x(), narrowest, 1e-12);  // beside the edge
    EXPECT_GT(mesh.nodes[23].x() - mesh.nodes[22].x(), 10 * narrowest);
}

TEST(GradedMesh, SurfaceFollowsTheProfileAndTheBottomStaysLevel) {
    GradedSettings graded = under_a_tube();
    graded.surface_x_mm = {0, 2, 4, 5.2};
    graded.surface_y_mm = {1, 0.7, 0.2, 0};
    const SolidMesh mesh = graded_mesh(graded, Formulation::axisymmetric);
    const std::vector<double> surface = graded_surface(graded, mesh);

    EXPECT_EQ(std::count(surface.begin(), surface.end(), 1.0), 24);
    EXPECT_NEAR(mesh.nodes[0].y(), 1, 1e-12);
    for (std::size_t n = 0; n < 24; ++n) {
        EXPECT_EQ(surface[n], 1);
        if (mesh.nodes[n].x() > 5.2 - 1e-12) {
            EXPECT_NEAR(mesh.nodes[n].y(), 0, 1e-12);
        }
        EXPECT_NEAR(mesh.nodes[mesh.nodes.size() - 1 - n].y(), -16, 1e-12);
    }
}

TEST(GradedMesh, AFinerOneHasTheNodesOfTheCoarseOne) {
    GradedSettings graded = under_a_tube();
    const SolidMesh coarse = graded_mesh(graded, Formulation::plane_strain);
    graded.refine = 2;
    const SolidMesh fine = graded_mesh(graded, Formulation::plane_strain);

    EXPECT_EQ(fine.num_elements(), 4 * coarse.num_elements());
    for (int j = 0; j <= 13; ++j)
        for (int i = 0; i <= 23; ++i)
            EXPECT_LT((fine.nodes[2 * j * 47 + 2 * i] - coarse.nodes[j * 24 + i]).norm(), 1e-12);
}

/// Under a tube whose rounded edge presses a cap down.
GradedSettings under_an_edge() {
    GradedSettings graded = under_a_tube();
    graded.face = TubeFace{5, 0.3};
    graded.edge_mm = graded.face->end_mm();
    graded.surface_x_mm = {0, 2, 4, 6};
    graded.surface_y_mm = {0.9, 0.6, 0.3, 0.1};
    return graded;
}

TEST(GradedMesh, StaysBelowTheRoundedEdgeOfATube) {
    const GradedSettings graded = under_an_edge();
    const SolidMesh mesh = graded_mesh(graded, Formulation::axisymmetric);
    const std::vector<double> surface = graded_surface(graded, mesh);

    int on_the_edge = 0;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
        if (surface[n] == 0) continue;
        const Vec3& at = mesh.nodes[n];
        const double from_centre = std::hypot(at.x() - 5.3, at.y() - 0.3);
        if (at.x() > 5.3) {
            EXPECT_NEAR(at.y(), 0, 1e-12);
        } else if (at.x() > 5) {
            EXPECT_GT(from_centre, 0.3 - 1e-12);
            on_the_edge += std::abs(from_centre - 0.3) < 1e-12;
        }
    }
    EXPECT_GE(on_the_edge, 3);
    EXPECT_EQ(std::count(surface.begin(), surface.end(), 1.0), 14 + 4 + 9 + 1);
}

TEST(GradedMesh, UnderAnEdgeHasAsManyNodesWhateverItsRadius) {
    GradedSettings graded = under_an_edge();
    const SolidMesh mesh = graded_mesh(graded, Formulation::axisymmetric);
    graded.face->edge_radius_mm += 1e-5;
    graded.edge_mm += 1e-5;
    const SolidMesh other = graded_mesh(graded, Formulation::axisymmetric);

    ASSERT_EQ(other.elements, mesh.elements);
    double farthest = 0;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
        farthest = std::max(farthest, (other.nodes[n] - mesh.nodes[n]).norm());
    EXPECT_GT(farthest, 1e-6);
    EXPECT_LT(farthest, 2e-4);
}

TEST(GradedMesh, ASteepRestUnderAnEdgeMovesWithItsSizesWithoutAJump) {
    for (const double hole_mm : {4.0, 5.0})
        for (const double edge_mm : {0.05, 0.13, 0.2, 0.25}) {
            const auto nodes_at = [&](double more_hole_mm, double more_edge_mm) {
                GradedSettings graded = under_an_edge();
                graded.face = TubeFace{hole_mm + more_hole_mm, edge_mm + more_edge_mm};
                graded.edge_mm = graded.face->end_mm();
                // down to the rim at 45 degrees, above the edge at the bore
                graded.surface_x_mm = {0, hole_mm - 1, hole_mm, hole_mm + edge_mm + 0.1};
                graded.surface_y_mm = {1.2, 1.1 + edge_mm, 0.1 + edge_mm, 0};
                return graded_mesh(graded, Formulation::axisymmetric).nodes;
            };
            constexpr double h = 1e-5;
            const auto base = nodes_at(0, 0);
            for (const auto& moved :
                 {nodes_at(h, 0), nodes_at(-h, 0), nodes_at(0, h), nodes_at(0, -h)})
                for (std::size_t n = 0; n < base.size(); ++n)
                    ASSERT_LT((moved[n] - base[n]).norm(), 100 * h)
                        << hole_mm << ", " << edge_mm << " at " << base[n].transpose();
        }
}

TEST(GradedMesh, ACoarserMeshHasEachSecondLineOfTheOther) {
    GradedSettings graded = under_an_edge();
    graded.columns_outside = 8;
    graded.rows = 14;
    const SolidMesh fine = graded_mesh(graded, Formulation::axisymmetric);
    const std::vector<double> fine_x = graded_columns(graded);
    graded.coarsen = 2;
    const SolidMesh coarse = graded_mesh(graded, Formulation::axisymmetric);
    const std::vector<double> x = graded_columns(graded);

    ASSERT_EQ(fine_x.size(), 27u);
    ASSERT_EQ(x.size(), 14u);
    EXPECT_EQ(coarse.num_elements(), 13 * 7);
    const std::vector<double> surface = graded_surface(graded, coarse);
    EXPECT_EQ(std::count(surface.begin(), surface.end(), 1.0), 14);
    for (std::size_t j = 0; j <= 7; ++j)
        for (std::size_t i = 0; i <= 13; ++i)
            EXPECT_LT((coarse.nodes[14 * j + i] - fine.nodes[27 * 2 * j + 2 * i]).norm(), 1e-12)
                << i << ", " << j;
    // and divided again it has as many lines as before, at other places between those
    graded.refine = 2;
    EXPECT_EQ(graded_columns(graded).size(), 27u);
}

TEST(GradedMesh, FoldsAndSizesThatLeaveNoRoomAreTold) {
    GradedSettings graded = under_a_tube();
    graded.surface_x_mm = {0, 4.9, 5, 5.2};
    graded.surface_y_mm = {8, 8, 0, 0};
    expect_refused([&] { graded_mesh(graded, Formulation::axisymmetric); }, {"fold", "x = "},
                   ErrorCode::mesh_failed);
    graded = under_a_tube();
    graded.depth_mm = 2;
    expect_refused([&] { graded_mesh(graded, Formulation::axisymmetric); }, {"13 rows", "2 mm"});
    graded = under_a_tube();
    graded.width_mm = 5;
    expect_refused([&] { graded_mesh(graded, Formulation::axisymmetric); }, {"edge", "width_mm"});
}

TEST(GradedMesh, TakesItsEdgeFromATube) {
    const auto made = [](const std::string& edge, const std::string& place = "[0, 0]",
                         const std::string& more = "") {
        return prepared(
            "[mesh]\nformulation = \"axisymmetric\"\n"
            "graded = {width_mm = 20, depth_mm = 16, " +
            edge + "}\n" + one_material +
            "[[fix]]\nwhere = {side = \"y-min\"}\n"
            "[[obstacle]]\nname = \"tube\"\nshape = \"tube\"\nplace_mm = " +
            place +
            "\ndirection = [0, -1]\nhole_radius_mm = 5\nedge_radius_mm = 0.25\n"
            "outer_radius_mm = 10\nwhere = {point_array = \"surface\"}\n" +
            more);
    };
    const auto tube = made("edge_of = \"tube\"");
    EXPECT_EQ(tube.model.mesh.num_elements(), 27 * 13);
    EXPECT_NEAR(tube.model.mesh.nodes[18].x(), 5.25, 1e-12);

    expect_refused([&] { made("edge_of = \"pipe\""); }, {"edge_of", "pipe", "tube"});
    expect_refused([&] { made("edge_of = \"tube\", edge_mm = 5"); }, {"edge_mm", "either"});
    expect_refused([&] { made("edge_of = \"tube\"", "[0, 1]"); }, {"\"tube\"", "[0, 0]"});
}

TEST(GradedMesh, MistakesInAFileAreTold) {
    const auto mesh = [](const std::string& keys, const std::string& more = "") {
        return prepared("[mesh]\nformulation = \"axisymmetric\"\n" + more + "graded = {" + keys +
                        "}\n" + one_material + "[[fix]]\nwhere = {side = \"y-min\"}\n");
    };
    const std::string sizes = "width_mm = 20, depth_mm = 16, edge_mm = 5";
    EXPECT_EQ(mesh(sizes + ", refine = 2").model.mesh.num_elements(), 4 * 23 * 13);
    expect_refused([&] { mesh("width_mm = 20, depth_mm = 16"); }, {"edge_mm"});
    expect_refused([&] { mesh(sizes + ", surface_x_mm = [0, 1, 2]"); }, {"surface_y_mm"});
    expect_refused([&] { mesh(sizes + ", surface_x_mm = [0, 2, 2], surface_y_mm = [0, 0, 0]"); },
                   {"ascending"});
    expect_refused([&] { mesh(sizes, "unit = \"m\"\n"); }, {"unit"});
    expect_refused([&] { mesh("width_mm = 20, depth_mm = 1, edge_mm = 5"); }, {"model.toml", "13"});
}

}  // namespace
}  // namespace palpate
