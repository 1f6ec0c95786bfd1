// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/grid_mesh.hpp"

#include <gtest/gtest.h>

#include "solver/model/surface_load.hpp"

namespace palpate {
namespace {

double volume_of(const SolidMesh& mesh) {
    double volume = 0;
    for (const PointGeometry& point : point_geometry(mesh)) volume += point.volume;
    return volume;
}

TEST(GridMesh, ABoxIsFilledAndConforms) {
    GridSettings grid;
    grid.size_mm = Vec3(3, 2, 1);
    grid.divisions = {3, 2, 2};
    const SolidMesh mesh = grid_mesh(grid, Formulation::solid);

    EXPECT_EQ(mesh.num_elements(), 6 * 12);
    EXPECT_NEAR(volume_of(mesh), 6, 1e-12);
    // Two triangles on each outer square; inner faces would show if cells did not fit together.
    EXPECT_EQ(boundary_faces(mesh).size(), 2u * 2 * (3 * 2 + 3 * 2 + 2 * 2));
}

TEST(GridMesh, ARectangleIsOfEitherKind) {
    GridSettings grid;
    grid.size_mm = Vec3(4, 2, 1);
    grid.divisions = {4, 3, 1};
    for (const ElementType type : {ElementType::quad4, ElementType::tri3}) {
        grid.type = type;
        const SolidMesh mesh = grid_mesh(grid, Formulation::plane_strain);

        EXPECT_EQ(mesh.num_elements(), type == ElementType::quad4 ? 12 : 24);
        EXPECT_NEAR(volume_of(mesh), 8, 1e-12);
        EXPECT_EQ(boundary_faces(mesh).size(), 14u);
    }
}

}  // namespace
}  // namespace palpate
