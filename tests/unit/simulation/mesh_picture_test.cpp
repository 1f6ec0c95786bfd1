// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/mesh_picture.hpp"

#include <gtest/gtest.h>

#include "host/apps/simulate/grid_mesh.hpp"

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

std::string picture_of(const SolidMesh& mesh, const PictureShape& shape) {
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(3 * mesh.num_nodes());
    return mesh_picture_svg(mesh, shape, rest, 1,
                            {"value", std::vector<double>(mesh.nodes.size(), 0.5), 0, 1}, "id");
}

std::string picture_of(Formulation formulation) {
    const SolidMesh mesh = mesh_of(formulation);
    return picture_of(mesh, body_shape(mesh));
}

TEST(MeshPicture, ShowsTheThreeSidesOfABoxThatFaceTheEye) {
    EXPECT_EQ(count(picture_of(Formulation::solid), "<path d='M"), 3u * 8);
}

TEST(MeshPicture, ShowsBothHalvesOfASectionThroughAnAxis) {
    EXPECT_EQ(count(picture_of(Formulation::plane_strain), "<path d='M"), 4u);
    EXPECT_EQ(count(picture_of(Formulation::axisymmetric), "<path d='M"), 8u);
}

TEST(MeshPicture, DrawsBothJawsOfATubeOnce) {
    const SolidMesh mesh = mesh_of(Formulation::axisymmetric);
    MeshPicture picture{"value", std::vector<double>(mesh.nodes.size(), 0.5), 0, 1, {Obstacle{}}};
    Obstacle& tube = picture.obstacles[0];
    tube.shape = ObstacleShape::tube;
    tube.place = Vec3(0, 3, 0);
    tube.direction = -Vec3::UnitY();
    tube.edge_radius_mm = tube.outer_edge_radius_mm = 0.2;
    tube.outer_radius_mm = 2;
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(3 * mesh.num_nodes());
    const std::string svg = mesh_picture_svg(mesh, body_shape(mesh), rest, 1, picture, "id");
    const std::size_t begin = svg.find("class='wall'");
    ASSERT_NE(begin, std::string::npos);
    const std::string wall = svg.substr(begin, svg.find("/>", begin) - begin);
    EXPECT_EQ(count(wall, "M"), 2u);
    // Bore, two edges of eight parts, rim, outer side.
    EXPECT_EQ(count(wall, "L"), 2u * 19);
    EXPECT_EQ(wall.find("nan"), std::string::npos);
}

/// Half the cross products of the rim.
double area_of(const PictureShape& shape, const SolidMesh& mesh) {
    double area = 0;
    for (const auto& patch : shape.patches) {
        const Vec3 first = shape.points[patch[0]].of(mesh.nodes);
        for (std::size_t a = 1; a + 1 < patch.size(); ++a) {
            const Vec3 along = shape.points[patch[a]].of(mesh.nodes) - first;
            area += 0.5 * along.cross(shape.points[patch[a + 1]].of(mesh.nodes) - first).norm();
        }
    }
    return area;
}

TEST(MeshPicture, ASectionFillsTheBodyAndHasItsRimAsOutline) {
    const SolidMesh mesh = mesh_of(Formulation::solid);
    const PictureShape section = section_shape(mesh, 1.2);

    EXPECT_NEAR(area_of(section, mesh), 4 * 2, 1e-12);
    for (const PicturePoint& point : section.points)
        EXPECT_NEAR(point.of(mesh.nodes).y(), 1.2, 1e-12);
    EXPECT_TRUE(section_shape(mesh, 4).patches.empty());
    const std::string svg = picture_of(mesh, section);
    const std::size_t rest = svg.find("class='rest'");
    // Cells of 2 mm x 1 mm have a point in the middle of each side, where a face is cut twice.
    EXPECT_EQ(count(svg.substr(rest, svg.find("/>", rest) - rest), "M"), 2u * (4 + 4));
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
