// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/deform.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "tests/unit/phantom/hollow_block.hpp"

namespace palpate {
namespace {

TEST(NodesOnRegion, AreThoseOfItsWallOnly) {
    const RegionMesh block = fixtures::region_block(
        {4, 4, 4}, Vec3(4, 4, 4),
        [](const Vec3& x) { return (x - Vec3(1.5, 1.5, 1.5)).norm() < 0.1 ? 3 : 1; }, {3});

    const auto on_region = nodes_on_region(block, 3);

    for (Index n = 0; n < block.mesh.num_nodes(); ++n) {
        const Vec3 from_centre = block.mesh.nodes[n] - Vec3(1.5, 1.5, 1.5);
        EXPECT_EQ(on_region[n], from_centre.cwiseAbs().maxCoeff() < 0.6) << n;
    }
}

/// The pelvis in cubes of about 10 mm: coarse, but with every wall of the real one.
class DeformedPelvis : public testing::Test {
protected:
    void SetUp() override {
        materials[1] = {10, 0.35};
        materials[2] = {80, 0.40};
        options.backend = "reference";
        anatomy = make_anatomy(1, Vec3::Ones());
        const ImageGrid cubes = grid_of_box(anatomy, Vec3(10, 10, 10));
        const RegionImage image = fill_shapes(anatomy, cubes);
        block = fixtures::region_block(
            cubes.size, anatomy.box_size,
            [&](const Vec3& x) {
                const Vec3 i = (x.cwiseQuotient(cubes.spacing)).array().floor();
                return Index(image.at(Index(i[0]), Index(i[1]), Index(i[2])));
            },
            {3, 4, 5, 6});
        for (Vec3& x : block.mesh.nodes) x += anatomy.box_corner;
        block.surface.vertices = block.mesh.nodes;
        hold_unused_nodes();
    }
    /// Nodes inside cavities belong to no tet: drop them.
    void hold_unused_nodes() {
        std::vector<Index> number(block.mesh.nodes.size(), -1);
        std::vector<Vec3> nodes;
        const auto renumber = [&](Index& node) {
            if (number[node] < 0) {
                number[node] = static_cast<Index>(nodes.size());
                nodes.push_back(block.mesh.nodes[node]);
            }
            node = number[node];
        };
        for (Tet& tet : block.mesh.tets) std::for_each(tet.begin(), tet.end(), renumber);
        for (Triangle& t : block.surface.triangles) std::for_each(t.begin(), t.end(), renumber);
        block.mesh.nodes = nodes;
        block.surface.vertices = nodes;
    }
    BodyMesh body(ElementType element = ElementType::tet4) const {
        return body_mesh(block, element);
    }
    PelvisAnatomy anatomy;
    RegionMesh block;
    std::vector<LinearElastic> materials = std::vector<LinearElastic>(7);
    LinearSolverOptions options;
};

/// mN mm
double energy_of(const Deformation& deformation) {
    double work = 0;
    for (std::size_t n = 0; n < deformation.force.size(); ++n)
        work += deformation.force[n].dot(deformation.displacement[n]);
    return 0.5 * work;
}

TEST_F(DeformedPelvis, MovesWallsAsPrescribedHoldsBonesAndCrushesNoElement) {
    const auto motions = make_wall_motions(anatomy, 1);

    const Deformation result =
        deform_by_walls(body(), materials, {motions}, 1, TissueLaw{}, options, {}).at(0);

    double smallest = std::numeric_limits<double>::max();
    for (const Tet& t : block.mesh.tets) {
        std::array<Vec3, 4> x, y;
        for (int c = 0; c < 4; ++c) {
            x[c] = block.mesh.nodes[t[c]];
            y[c] = x[c] + result.displacement[t[c]];
        }
        smallest = std::min(
            smallest, tet_volume(y[0], y[1], y[2], y[3]) / tet_volume(x[0], x[1], x[2], x[3]));
    }
    EXPECT_GT(smallest, 0.2);
    EXPECT_NEAR(smallest, result.smallest_jacobian, 1e-9);
    EXPECT_GT(result.load_scale, 0.3);
    const auto on_bladder = nodes_on_region(block, first_organ_region + bladder);
    const auto on_bone = nodes_on_region(block, first_organ_region + bone_left);
    for (Index n = 0; n < block.mesh.num_nodes(); ++n) {
        const Vec3& u = result.displacement[n];
        if (on_bone[n]) {
            EXPECT_LT(u.norm(), 1e-7);
        }
        if (!on_bladder[n]) continue;
        const Vec3 expected = result.load_scale * motions[0].displacement(block.mesh.nodes[n]);
        EXPECT_LT((u - expected).norm(), 1e-6);
    }
}

TEST_F(DeformedPelvis, BalancesForcesBetweenWallsBonesAndBox) {
    const Deformation result = deform_by_walls(body(), materials, {make_wall_motions(anatomy, 1)},
                                               1, TissueLaw{}, options, {})
                                   .at(0);

    const std::vector<Vec3>& forces = result.force;
    std::vector<std::uint8_t> held(forces.size(), 0);
    double largest_held = 0, largest_free = 0;
    for (const Index region : {outside_region, 3, 4, 5, 6}) {
        const auto on_region = nodes_on_region(block, region);
        for (std::size_t n = 0; n < held.size(); ++n) held[n] |= on_region[n];
    }
    for (std::size_t n = 0; n < held.size(); ++n) {
        double& largest = held[n] ? largest_held : largest_free;
        largest = std::max(largest, forces[n].norm());
    }
    EXPECT_GT(largest_held, 100);
    EXPECT_LT(largest_free, 1e-6 * largest_held);
}

TEST_F(DeformedPelvis, StoresLessTheBetterItsElementsBend) {
    const BodyMesh quadratic = body(ElementType::tet10);
    const BodyMesh pieces = body_mesh(linear_pieces_of(quadratic), ElementType::tet4);
    constexpr double load_factor = 0.1;  // no element suffers
    std::vector<double> energies;

    for (const BodyMesh& mesh : {body(), pieces, quadratic}) {
        const Deformation result = deform_by_walls(mesh, materials, {make_wall_motions(anatomy, 1)},
                                                   load_factor, TissueLaw{}, options, {})
                                       .at(0);
        EXPECT_EQ(result.load_scale, load_factor);
        EXPECT_EQ(result.displacement.size(), mesh.mesh.nodes.size());
        energies.push_back(energy_of(result));
    }

    EXPECT_LT(energies[1], energies[0]);
    EXPECT_LT(energies[2], energies[1]);
    EXPECT_GT(energies[2], 0.5 * energies[1]);
}

TEST_F(DeformedPelvis, MovesUnderEachLoadAsUnderItAlone) {
    const std::vector<std::vector<WallMotion>> loads{make_wall_motions(anatomy, 1),
                                                     make_wall_motions(anatomy, 2)};

    const auto both = deform_by_walls(body(), materials, loads, 1, TissueLaw{}, options, {});

    ASSERT_EQ(both.size(), 2u);
    for (std::size_t k = 0; k < loads.size(); ++k) {
        const Deformation alone =
            deform_by_walls(body(), materials, {loads[k]}, 1, TissueLaw{}, options, {}).at(0);
        EXPECT_EQ(alone.load_scale, both[k].load_scale);
        for (std::size_t n = 0; n < alone.displacement.size(); ++n)
            EXPECT_LT((alone.displacement[n] - both[k].displacement[n]).norm(), 1e-6);
    }
    EXPECT_GT((both[0].displacement[0] - both[1].displacement[0]).norm() +
                  std::abs(both[0].smallest_jacobian - both[1].smallest_jacobian),
              1e-3);
}

}  // namespace
}  // namespace palpate
