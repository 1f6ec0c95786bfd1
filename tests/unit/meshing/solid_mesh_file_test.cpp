// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/solid_mesh_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class SolidMeshFiles : public ::testing::Test {
protected:
    void SetUp() override {
        folder = fs::temp_directory_path() / ("palpate_solid_mesh_" + std::to_string(::getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }

    /// A legacy file with these cells over a unit tetrahedron and one point more.
    fs::path file(const std::string& cells, const std::string& data = "") {
        const fs::path path = folder / "mesh.vtk";
        std::ofstream(path)
            << "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\n"
               "POINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 9 9 9\n"
            << cells << data;
        return path;
    }
    std::string refusal(const fs::path& path, Formulation formulation,
                        const std::optional<std::string>& region = {}) {
        try {
            read_solid_mesh(path, formulation, region);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::input_unusable) << error.what();
            return error.what();
        }
        return "accepted";
    }
    fs::path folder;
};

TEST_F(SolidMeshFiles, EveryElementTypeIsReadAsItWasWritten) {
    for (const ElementType type : element_types()) {
        const ElementTable& table = element_table(type);
        SolidMesh mesh;
        mesh.type = type;
        mesh.formulation = table.dimension == 3 ? Formulation::solid : Formulation::plane_strain;
        for (int a = 0; a < table.num_nodes; ++a) {
            Vec3 place = Vec3::Zero();
            for (int j = 0; j < table.dimension; ++j)
                place[j] = table.reference[a * table.dimension + j];
            mesh.nodes.push_back(place);
            mesh.elements.push_back(a);
        }
        mesh.region = {4};
        write_solid_mesh(folder / "mesh.vtu", mesh,
                         {.point_scalars = {},
                          .point_vectors = {{"displacement", mesh.nodes}},
                          .cell_scalars = {},
                          .cell_tensors = {}});

        const SolidMeshFile read = read_solid_mesh(folder / "mesh.vtu", mesh.formulation, "region");

        EXPECT_EQ(read.mesh.type, type) << table.name;
        EXPECT_EQ(read.mesh.elements, mesh.elements) << table.name;
        EXPECT_EQ(read.mesh.nodes, mesh.nodes) << table.name;
        EXPECT_EQ(read.mesh.region, mesh.region) << table.name;
    }
}

TEST_F(SolidMeshFiles, ElementsInsideOutAreTurnedRoundWithTheirMiddles) {
    for (const ElementType type : element_types()) {
        const ElementTable& table = element_table(type);
        SolidMesh mesh;
        mesh.type = type;
        mesh.formulation = table.dimension == 3 ? Formulation::solid : Formulation::plane_strain;
        for (int a = 0; a < table.num_nodes; ++a) {
            Vec3 place = Vec3::Zero();
            for (int j = 0; j < table.dimension; ++j)
                place[j] = table.reference[a * table.dimension + j];
            place.x() = -place.x();
            mesh.nodes.push_back(place);
            mesh.elements.push_back(a);
        }
        mesh.region = {1};
        write_solid_mesh(folder / "mesh.vtu", mesh, {});

        const SolidMeshFile read = read_solid_mesh(folder / "mesh.vtu", mesh.formulation, {});

        double size = 0, weight = 0;
        for (const PointGeometry& point : point_geometry(read.mesh)) size += point.volume;
        for (const double w : table.weight) weight += w;
        EXPECT_NEAR(size, weight, 1e-12) << table.name;
    }
}

TEST_F(SolidMeshFiles, SurfaceCellsAndUnusedPointsAreLeftOut) {
    const SolidMeshFile read = read_solid_mesh(
        file("CELLS 2 9\n3 0 1 2\n4 0 1 2 3\nCELL_TYPES 2\n5\n10\n",
             "POINT_DATA 5\nSCALARS wall double 1\nLOOKUP_TABLE default\n1 0 0 1 7\n"),
        Formulation::solid, {});

    EXPECT_EQ(read.mesh.num_elements(), 1);
    EXPECT_EQ(read.mesh.num_nodes(), 4);
    EXPECT_EQ(read.mesh.region, (std::vector<Index>{1}));
    EXPECT_EQ(read.point_scalars.at("wall"), (std::vector<double>{1, 0, 0, 1}));
}

TEST_F(SolidMeshFiles, CellsThatAreNoElementsOfTheFormulationAreRefused) {
    const fs::path tet = file("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n");
    EXPECT_NE(refusal(tet, Formulation::plane_stress).find("VTK type 10"), std::string::npos);
    EXPECT_NE(refusal(tet, Formulation::solid, "tissue").find("'tissue'"), std::string::npos);
    const fs::path mixed = file("CELLS 2 9\n3 0 1 2\n4 0 1 2 3\nCELL_TYPES 2\n5\n9\n");
    EXPECT_NE(refusal(mixed, Formulation::plane_strain).find("tri3 and quad4"), std::string::npos);
    EXPECT_NE(refusal(mixed, Formulation::solid).find("holds no"), std::string::npos);
}

}  // namespace
}  // namespace palpate
