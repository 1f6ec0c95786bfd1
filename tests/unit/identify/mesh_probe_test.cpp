// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/mesh_probe.hpp"

#include <gtest/gtest.h>

#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

SolidMesh mesh_of(const std::string& mesh) {
    return prepared(mesh + one_material + "[[fix]]\nwhere = {side = \"x-min\"}\n").model.mesh;
}

/// A linear field is read exactly wherever the place is.
void expect_linear_fields_exact(const SolidMesh& mesh, const std::vector<Vec3>& places) {
    Mat3 slope;
    slope << 1, 2, 3, -4, 5, 0.5, 0, 1, 2;
    if (mesh.table().dimension == 2) slope.col(2).setZero();
    Eigen::VectorXd u(3 * mesh.num_nodes());
    for (Index n = 0; n < mesh.num_nodes(); ++n) u.segment<3>(3 * n) = slope * mesh.nodes[n];
    const MeshProbe probe(mesh);
    for (const Vec3& place : places) {
        const auto found = probe.find(place);
        ASSERT_TRUE(found) << place.transpose();
        EXPECT_LT((found->displacement(u) - slope * place).norm(), 1e-10) << place.transpose();
    }
}

TEST(MeshProbe, ReadsLinearFieldsExactlyInEveryElement) {
    const std::vector<Vec3> solid{{0.3, 1.7, 0.4}, {4, 4, 2}, {0, 0, 0}, {2, 2, 1}};
    const std::string box = "[mesh]\nbox = {size_mm = [4, 4, 2], divisions = [2, 2, 1]}\n";
    expect_linear_fields_exact(mesh_of(box), solid);
    expect_linear_fields_exact(mesh_of(box + "quadratic = true\n"), solid);
    const std::vector<Vec3> plane{{0.3, 1.7, 0}, {4, 4, 0}, {0, 0, 0}, {2, 2, 0}};
    for (const char* element : {"quad4", "tri3"})
        expect_linear_fields_exact(
            mesh_of(std::string("[mesh]\nformulation = \"plane-strain\"\nrectangle = {size_mm = "
                                "[4, 4], divisions = [2, 3], element = \"") +
                    element + "\"}\n"),
            plane);
}

TEST(MeshProbe, FindsNothingOutside) {
    const SolidMesh mesh = mesh_of("[mesh]\nbox = {size_mm = [4, 4, 2], divisions = [2, 2, 1]}\n");
    EXPECT_FALSE(MeshProbe(mesh).find({4.01, 1, 1}));
    EXPECT_FALSE(MeshProbe(mesh).find({1, 1, -0.5}));
}

}  // namespace
}  // namespace palpate
