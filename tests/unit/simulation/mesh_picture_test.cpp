// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/simulation/mesh_picture.hpp"

#include <gtest/gtest.h>

#include "host/simulation/grid_mesh.hpp"

namespace palpate {
namespace {

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++n;
    return n;
}

SolidMesh mesh_of(Formulation formulation) {
    GridSettings grid;
    grid.size_mm = Vec3(4, 3, 2);
    grid.divisions = {2, 2, 2};
    grid.type = formulation == Formulation::solid ? ElementType::tet4 : ElementType::quad4;
    return grid_mesh(grid, formulation);
}

std::string picture_of(const SolidMesh& mesh) {
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(3 * mesh.num_nodes());
    return mesh_picture_svg(mesh, rest, 1,
                            {"value", std::vector<double>(mesh.nodes.size(), 0.5), 0, 1}, "id");
}

TEST(MeshPicture, ShowsTheThreeSidesOfABoxThatFaceTheEye) {
    EXPECT_EQ(count(picture_of(mesh_of(Formulation::solid)), "<path d='M"), 3u * 8);
}

TEST(MeshPicture, ShowsBothHalvesOfASectionThroughAnAxis) {
    EXPECT_EQ(count(picture_of(mesh_of(Formulation::plane_strain)), "<path d='M"), 4u);
    EXPECT_EQ(count(picture_of(mesh_of(Formulation::axisymmetric)), "<path d='M"), 8u);
}

TEST(MeshPicture, NodesHaveTheMeanOfTheirElements) {
    const SolidMesh mesh = mesh_of(Formulation::plane_strain);
    const std::vector<double> nodes = at_nodes(mesh, {1, 2, 3, 6});

    EXPECT_DOUBLE_EQ(nodes[0], 1);
    EXPECT_DOUBLE_EQ(nodes[1], 1.5);
    EXPECT_DOUBLE_EQ(nodes[4], 3);
}

TEST(MeshPicture, OnlySmallDisplacementsAreEnlarged) {
    const SolidMesh mesh = mesh_of(Formulation::plane_strain);

    EXPECT_DOUBLE_EQ(enlargement(mesh, 1), 1);
    EXPECT_DOUBLE_EQ(enlargement(mesh, 0), 1);
    EXPECT_DOUBLE_EQ(enlargement(mesh, 0.001), 100);
}

}  // namespace
}  // namespace palpate
