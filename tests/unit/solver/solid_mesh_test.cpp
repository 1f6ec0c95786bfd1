// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/solid_mesh.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "solver/base/error.hpp"
#include "solver/model/quadratic_mesh.hpp"
#include "solver/model/surface_load.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

SolidMesh tilted_box() {
    Mesh box = fixtures::box_mesh({3, 2, 2}, Vec3(3, 2, 2.5));
    fixtures::shake_inner_nodes(box, 0.15, 4);
    return solid_mesh_of(box);
}

SolidMesh rectangle(ElementType type, Formulation formulation) {
    SolidMesh mesh = fixtures::rectangle_mesh(type, formulation, {3, 2}, {3.0, 2.0});
    mesh.nodes[5].x() += 0.2;  // an inner node
    return mesh;
}

std::vector<SolidMesh> every_kind() {
    return {tilted_box(), with_edge_nodes(tilted_box()),
            rectangle(ElementType::tri3, Formulation::plane_strain),
            with_edge_nodes(rectangle(ElementType::tri3, Formulation::plane_stress)),
            rectangle(ElementType::quad4, Formulation::axisymmetric)};
}

TEST(SolidMesh, GradientsOfAnAffineFieldAreExactEverywhere) {
    const Mat3 slope = (Mat3() << 0.3, -0.1, 0.2, 0.4, 0.1, -0.3, 0.2, 0.5, 0.1).finished();
    for (const SolidMesh& mesh : every_kind()) {
        check_mesh(mesh);
        const auto geometry = point_geometry(mesh);
        const int points = mesh.table().num_points;
        ASSERT_EQ(geometry.size(), static_cast<std::size_t>(mesh.num_elements()) * points);
        for (Index e = 0; e < mesh.num_elements(); ++e)
            for (int q = 0; q < points; ++q) {
                Mat3 found = Mat3::Zero();
                const PointGeometry& at = geometry[e * points + q];
                for (int a = 0; a < mesh.table().num_nodes; ++a)
                    found += slope * mesh.nodes[mesh.nodes_of(e)[a]] *
                             Eigen::Map<const Vec3>(at.gradient[a].data()).transpose();
                Mat3 expected = slope;
                if (mesh.formulation != Formulation::solid) expected.col(2).setZero();
                EXPECT_LT((found - expected).norm(), 1e-13) << mesh.table().name;
            }
    }
}

double volume_of(const SolidMesh& mesh) {
    double sum = 0;
    for (const PointGeometry& at : point_geometry(mesh)) sum += at.volume;
    return sum;
}

TEST(SolidMesh, VolumesAddUp) {
    EXPECT_NEAR(volume_of(tilted_box()), 15.0, 1e-12);
    EXPECT_NEAR(volume_of(with_edge_nodes(tilted_box())), 15.0, 1e-12);
    SolidMesh plate = rectangle(ElementType::tri3, Formulation::plane_stress);
    plate.thickness_mm = 0.5;
    EXPECT_NEAR(volume_of(plate), 3.0, 1e-12);
    // A cylinder of radius 3 and height 2.
    EXPECT_NEAR(volume_of(rectangle(ElementType::quad4, Formulation::axisymmetric)),
                std::numbers::pi * 9 * 2, 1e-10);
}

// The divergence theorem: a closed surface under a traction -p n pulls nowhere, and x . n over it
// is three times (in a plane twice) the volume inside.
TEST(SurfaceLoad, BoundaryFacesAreClosedAndFaceOutward) {
    for (const SolidMesh& mesh : every_kind()) {
        const auto faces = boundary_faces(mesh);
        const bool is_solid = mesh.formulation == Formulation::solid;
        if (mesh.formulation == Formulation::axisymmetric) continue;
        const Eigen::VectorXd pressure =
            traction_forces(mesh, faces, [](const Vec3&, const Vec3& n) { return Vec3(-n); });
        Vec3 sum = Vec3::Zero();
        double work = 0;
        for (Index n = 0; n < mesh.num_nodes(); ++n) {
            sum += pressure.segment<3>(3 * n);
            work -= pressure.segment<3>(3 * n).dot(mesh.nodes[n]);
        }
        EXPECT_LT(sum.norm(), 1e-12) << mesh.table().name;
        EXPECT_NEAR(work, (is_solid ? 3 : 2) * volume_of(mesh), 1e-12) << mesh.table().name;
    }
}

TEST(SurfaceLoad, AboutAnAxisTheWholeCircumferenceIsLoaded) {
    const SolidMesh mesh = rectangle(ElementType::quad4, Formulation::axisymmetric);
    const auto lid = boundary_faces(mesh, [&](Index n) { return mesh.nodes[n].y() > 2 - 1e-9; });
    EXPECT_EQ(lid.size(), 3u);
    const Eigen::VectorXd forces =
        traction_forces(mesh, lid, [](const Vec3&, const Vec3& n) { return n; });
    double sum = 0;
    for (Index n = 0; n < mesh.num_nodes(); ++n) sum += forces[3 * n + 1];
    EXPECT_NEAR(sum, std::numbers::pi * 9, 1e-12);
}

TEST(SolidMesh, TheHoopStrainOfARadialStretchIsTheStretch) {
    const SolidMesh mesh = rectangle(ElementType::quad4, Formulation::axisymmetric);
    const auto geometry = point_geometry(mesh);
    for (Index e = 0; e < mesh.num_elements(); ++e)
        for (int q = 0; q < 4; ++q) {
            double hoop = 0;
            for (int a = 0; a < 4; ++a)
                hoop += geometry[4 * e + q].hoop[a] * 0.07 * mesh.nodes[mesh.nodes_of(e)[a]].x();
            EXPECT_NEAR(hoop, 0.07, 1e-14);
        }
}

TEST(SolidMesh, TheGraphHasEveryPairOfAnElement) {
    for (const SolidMesh& mesh : every_kind()) {
        const Adjacency graph = node_graph(mesh);
        ASSERT_EQ(graph.num_lists(), mesh.num_nodes());
        for (Index e = 0; e < mesh.num_elements(); ++e)
            for (const Index a : mesh.nodes_of(e))
                for (const Index b : mesh.nodes_of(e))
                    EXPECT_TRUE(std::binary_search(graph.items.begin() + graph.offsets[a],
                                                   graph.items.begin() + graph.offsets[a + 1], b));
    }
}

TEST(SolidMesh, EdgeNodesAreSharedAndInTheMiddle) {
    const SolidMesh coarse = solid_mesh_of(fixtures::box_mesh({1, 1, 1}, Vec3(2, 2, 2)));
    const SolidMesh mesh = with_edge_nodes(coarse);
    EXPECT_EQ(mesh.table().name, "tet10");
    EXPECT_EQ(mesh.num_nodes(), 27);  // the corners, edges, face and body diagonals of one cube
    EXPECT_THROW(with_edge_nodes(mesh), Error);
}

TEST(SolidMesh, LinearPiecesOfTet10FillItOnItsOwnNodes) {
    const SolidMesh coarse = solid_mesh_of(fixtures::box_mesh({2, 1, 1}, Vec3(2, 3, 4)));
    const SolidMesh mesh = with_edge_nodes(coarse);

    const Mesh pieces = linear_mesh_of(mesh), corners = corner_mesh_of(mesh);

    EXPECT_EQ(pieces.nodes, mesh.nodes);
    ASSERT_EQ(pieces.num_tets(), 8 * mesh.num_elements());
    ASSERT_EQ(corners.num_tets(), mesh.num_elements());
    double volume = 0;
    for (Index t = 0; t < pieces.num_tets(); ++t) {
        EXPECT_EQ(pieces.region[t], mesh.region[t / 8]);
        EXPECT_NEAR(tet_volume(pieces, t), tet_volume(corners, t / 8) / 8, 1e-12);
        volume += tet_volume(pieces, t);
    }
    EXPECT_NEAR(volume, 24, 1e-9);
    EXPECT_EQ(linear_mesh_of(coarse).num_tets(), coarse.num_elements());
    EXPECT_THROW(linear_mesh_of(rectangle(ElementType::quad4, Formulation::plane_strain)), Error);
}

std::string complaint(const SolidMesh& mesh) {
    try {
        check_mesh(mesh);
        point_geometry(mesh);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(SolidMesh, BrokenRulesAreNamed) {
    SolidMesh mesh = tilted_box();
    mesh.formulation = Formulation::axisymmetric;
    EXPECT_NE(complaint(mesh).find("axisymmetric"), std::string::npos);
    mesh = tilted_box();
    mesh.elements[7] = 999;
    EXPECT_NE(complaint(mesh).find("999"), std::string::npos);
    mesh = tilted_box();
    mesh.elements.pop_back();
    EXPECT_NE(complaint(mesh).find("node numbers per element"), std::string::npos);
    mesh = tilted_box();
    std::swap(mesh.elements[4], mesh.elements[5]);
    EXPECT_NE(complaint(mesh).find("element 1 is degenerate"), std::string::npos);
    mesh = rectangle(ElementType::quad4, Formulation::axisymmetric);
    mesh.nodes[0].x() = -1;
    EXPECT_NE(complaint(mesh).find("negative distance"), std::string::npos);
    mesh = rectangle(ElementType::tri3, Formulation::plane_strain);
    mesh.nodes[2].z() = 1;
    EXPECT_NE(complaint(mesh).find("plane z = 0"), std::string::npos);
    mesh = rectangle(ElementType::tri3, Formulation::plane_strain);
    mesh.thickness_mm = 0;
    EXPECT_NE(complaint(mesh).find("thickness"), std::string::npos);
    EXPECT_THROW(formulation_of("plane"), Error);
    EXPECT_EQ(formulation_of("plane-stress"), Formulation::plane_stress);
}

}  // namespace
}  // namespace palpate
