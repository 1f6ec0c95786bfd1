// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/tumour.hpp"

#include <gtest/gtest.h>

#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

double volume_of(const Mesh& mesh, Index region) {
    double volume = 0;
    for (Index t = 0; t < mesh.num_tets(); ++t)
        if (mesh.region[t] == region) volume += tet_volume(mesh, t);
    return volume;
}

TEST(Tumour, FillsTheFractionThatIsAskedFor) {
    for (const double fraction : {0.0, 0.1, 0.25, 0.75, 1.0}) {
        Mesh mesh = fixtures::box_mesh({10, 10, 10}, Vec3(10, 10, 10));

        const double filled = mark_ball(mesh, 0, 7, Vec3(3, 4, 5), fraction);

        EXPECT_NEAR(filled, fraction, 1e-3);
        EXPECT_NEAR(volume_of(mesh, 7), 1000 * filled, 1e-9);
        EXPECT_NEAR(volume_of(mesh, 0) + volume_of(mesh, 7), 1000, 1e-9);
    }
}

TEST(Tumour, IsABallAndLeavesOtherRegionsAlone) {
    Mesh mesh = fixtures::box_mesh({10, 10, 10}, Vec3(10, 10, 10));
    const Vec3 centre(5, 5, 5);
    fixtures::set_inclusion(mesh, [](const Vec3& x) { return x[2] > 5; });

    mark_ball(mesh, 0, 7, centre, 0.1);

    const double radius = std::cbrt(2 * 50 * 3 / (4 * 3.14159265));  // of the half ball
    for (Index t = 0; t < mesh.num_tets(); ++t) {
        Vec3 x = Vec3::Zero();
        for (const Index node : mesh.tets[t]) x += 0.25 * mesh.nodes[node];
        if (x[2] > 5) {
            EXPECT_EQ(mesh.region[t], 1);
        }
        if (x[2] < 5 && (x - centre).norm() < radius - 0.5) {
            EXPECT_EQ(mesh.region[t], 7);
        }
        if (x[2] < 5 && (x - centre).norm() > radius + 0.5) {
            EXPECT_EQ(mesh.region[t], 0);
        }
    }
}

}  // namespace
}  // namespace palpate
