// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/body_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "host/apps/recover/modelling/build_model.hpp"
#include "solver/base/error.hpp"
#include "solver/condense/condensation.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "tests/unit/phantom/hollow_block.hpp"

namespace palpate {
namespace {

constexpr double edge_mm = 10;

/// A cube of tissue, region 2, in the background, with a hollow driven cube, region 3, beside it.
RegionMesh cubes() {
    return fixtures::region_block({6, 4, 4}, Vec3(60, 40, 40),
                                  [](const Vec3& x) {
                                      const auto is_in = [&](double low, double high) {
                                          return x.x() > low && x.x() < high &&
                                                 std::abs(x.y() - 20) < edge_mm &&
                                                 std::abs(x.z() - 20) < edge_mm;
                                      };
                                      if (is_in(10, 30)) return Index(2);
                                      return is_in(30, 40) ? Index(3) : Index(1);
                                  },
                                  {3});
}

Settings two_organs() {
    return parse_settings(
        "[background]\nstiffness_kpa = 10.0\n"
        "[[organ]]\nname = \"cube\"\nlabel = 1\nrole = \"tissue\"\nstiffness_kpa = \"unknown\"\n"
        "[[organ]]\nname = \"balloon\"\nlabel = 2\nrole = \"driven\"\n",
        "cubes");
}

double area_of(const RegionSurface& surface, Index region) {
    return surface_area(surface_of_region(surface, region));
}

TEST(BodyMesh, SurfaceOfTet10IsTheSameThroughTheMidSideNodes) {
    const BodyMesh linear = body_mesh(cubes()), quadratic = body_mesh(cubes(), ElementType::tet10);

    EXPECT_EQ(quadratic.surface.vertices, quadratic.mesh.nodes);
    for (const Index region : {2, 3}) {
        const Surface coarse = surface_of_region(linear.surface, region),
                      fine = surface_of_region(quadratic.surface, region);
        EXPECT_EQ(fine.triangles.size(), 4 * coarse.triangles.size());
        EXPECT_NEAR(surface_area(fine), surface_area(coarse), 1e-9);
        EXPECT_NEAR(enclosed_volume(fine), enclosed_volume(coarse), 1e-9);
    }
    EXPECT_NEAR(area_of(linear.surface, 2), 2400, 1e-9);
}

/// Else an interior node would couple two regions, and condensation would refuse.
TEST(BodyMesh, EveryNodeBetweenRegionsIsInTheSurface) {
    const BodyMesh body = body_mesh(cubes(), ElementType::tet10);
    std::set<Index> in_surface;
    for (const Triangle& t : body.surface.triangles) in_surface.insert(t.begin(), t.end());
    std::vector<std::set<Index>> regions(body.mesh.nodes.size());
    for (Index e = 0; e < body.mesh.num_elements(); ++e)
        for (const Index n : body.mesh.nodes_of(e)) regions[n].insert(body.mesh.region[e]);

    Index between = 0;
    for (Index n = 0; n < body.mesh.num_nodes(); ++n) {
        if (regions[n].size() < 2) continue;
        ++between;
        EXPECT_TRUE(in_surface.contains(n)) << n;
    }
    EXPECT_EQ(between, 89);  // 98 of the cube, 9 of them between it and the hollow balloon alone
}

TEST(BodyMesh, MidSideNodesOfWallsAreDrivenAndOfTissueObserved) {
    const RecoveryModel linear = build_model(body_mesh(cubes()), two_organs());
    const RecoveryModel quadratic =
        build_model(body_mesh(cubes(), ElementType::tet10), two_organs());

    const auto is_on_balloon = [](const Vec3& x) {  // its box, 30 to 40 and 10 to 30 mm
        const Vec3 outside = (x - Vec3(35, 20, 20)).cwiseAbs() - Vec3(5, 10, 10);
        return std::abs(outside.maxCoeff()) < 1e-9;
    };
    EXPECT_GT(quadratic.driven.size(), 3 * linear.driven.size());
    for (const Index n : quadratic.driven)
        EXPECT_TRUE(is_on_balloon(quadratic.model.mesh.nodes[n]));
    EXPECT_GT(quadratic.observed.size(), 3 * linear.observed.size());
    const auto regions = condense(quadratic.model, quadratic.observed, quadratic.driven, [] {
        LinearSolverOptions options;
        options.method = LinearMethod::direct;
        return options;
    }());
    EXPECT_EQ(regions.size(), 2u);
}

/// A volume in which the balloon can be found.
LabelField balloon_field() {
    RegionImage image;
    image.grid.size = {64, 44, 44};
    image.grid.origin = Vec3::Constant(-1.5);
    image.voxels.assign(image.grid.num_voxels(), background_region);
    for (Index k = 0; k < 44; ++k)
        for (Index j = 0; j < 44; ++j)
            for (Index i = 0; i < 64; ++i) {
                const Vec3 x = image.grid.to_point(Vec3(i, j, k));
                if ((x - Vec3(35, 20, 20)).cwiseAbs().cwiseQuotient(Vec3(5, 10, 10)).maxCoeff() < 1)
                    image.at(i, j, k) = 3;
            }
    return LabelField(image, 4);
}

TEST(BodyMesh, AReadyMeshOfTet10IsTheOneThatTet4Becomes) {
    const LabelField field = balloon_field();
    const SolidMesh tets = solid_mesh_of(cubes().mesh);

    const BodyMesh made = body_mesh(tets, field, two_organs(), ElementType::tet10),
                   given = body_mesh(with_edge_nodes(tets), field, two_organs());

    EXPECT_EQ(given.mesh.type, ElementType::tet10);
    EXPECT_EQ(made.mesh.elements, given.mesh.elements);
    EXPECT_EQ(made.surface.triangles, given.surface.triangles);
    EXPECT_EQ(made.surface.regions, given.surface.regions);
    EXPECT_NEAR(area_of(given.surface, 2), 2400, 1e-9);
    EXPECT_NEAR(area_of(given.surface, 3), 1600, 1e-9);
}

TEST(BodyMesh, RefusesAReadyMeshThatIsFoldedOver) {
    SolidMesh mesh = with_edge_nodes(solid_mesh_of(cubes().mesh));
    for (Index& label : mesh.region) --label;  // file labels: background 0, cube 1
    EXPECT_EQ(with_region_numbers(mesh, two_organs(), "cubes.vtu").num_elements(),
              mesh.num_elements());
    mesh.nodes[mesh.nodes_of(0)[4]] = mesh.nodes[mesh.nodes_of(0)[3]];

    try {
        with_region_numbers(mesh, two_organs(), "cubes.vtu");
        FAIL() << "a folded element";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        EXPECT_NE(std::string(error.what()).find("cubes.vtu: element"), std::string::npos)
            << error.what();
    }
}

TEST(BodyMesh, TakesTetrahedraOnly) {
    EXPECT_EQ(recovery_element_of("tet10"), ElementType::tet10);
    EXPECT_THROW(recovery_element_of("quad4"), Error);
    EXPECT_THROW(body_mesh(cubes(), ElementType::tri3), Error);
}

}  // namespace
}  // namespace palpate
