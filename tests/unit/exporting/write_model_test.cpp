// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/export/write_model.hpp"

#include "host/geometry/meshing/mesh_files.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/exporting/two_tet_model.hpp"
#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {
namespace {

using testing::two_tet_model;
using WriteModelFile = TemporaryFolderTest;

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(FebioModel, HasMegapascalsAndItsOwnWordForEachLaw) {
    RecoveredModel model = two_tet_model();
    const std::string linear = febio_model(model, WallLoad::displacement);
    model.law = TissueLaw{"neo-hookean"};
    const std::string finite = febio_model(model, WallLoad::displacement);

    EXPECT_TRUE(holds(linear, "name=\"prostate_peripheral_zone\" type=\"isotropic elastic\""));
    EXPECT_TRUE(holds(linear, "<E>0.06</E>\n      <v>0.4</v>"));
    EXPECT_TRUE(holds(finite, "type=\"neo-Hookean\""));
    EXPECT_FALSE(holds(finite, "isotropic elastic"));
}

TEST(FebioModel, MovesOrPushesTheWall) {
    const std::string moved = febio_model(two_tet_model(), WallLoad::displacement);
    const std::string pushed = febio_model(two_tet_model(), WallLoad::force);

    EXPECT_TRUE(holds(moved, "<NodeSet name=\"driven\">5</NodeSet>"));
    EXPECT_TRUE(holds(moved, "<node lid=\"1\">-0.5</node>"));
    EXPECT_FALSE(holds(moved, "nodal_force"));
    EXPECT_TRUE(holds(pushed, "<node lid=\"1\">1.5,-0.02,0.003</node>"));
    EXPECT_FALSE(holds(pushed, "prescribed displacement"));
}

TEST(AbaqusDeck, HoldsMaterialsWallsAndSets) {
    const std::string deck = abaqus_deck(two_tet_model(), WallLoad::displacement);

    EXPECT_TRUE(
        holds(deck, "*ELEMENT, TYPE=C3D4, ELSET=E_prostate_peripheral_zone\n2, 2, 5, 3, 4\n"));
    EXPECT_TRUE(holds(deck, "*MATERIAL, NAME=M_background\n*ELASTIC\n0.01, 0.35\n"));
    EXPECT_TRUE(holds(deck, "*NSET, NSET=FIXED\n1, 2, 3,\n"));
    EXPECT_TRUE(holds(deck, "5, 3, 3, 0.75\n"));
    EXPECT_TRUE(holds(abaqus_deck(two_tet_model(), WallLoad::force), "*CLOAD\n5, 1, 1.5\n"));
}

TEST(AbaqusDeck, SaysLargeDeformation) {
    RecoveredModel model = two_tet_model();
    model.law = TissueLaw{"neo-hookean-reduced"};
    const std::string deck = abaqus_deck(model, WallLoad::displacement);

    // 10 kPa and 0.35: C10 = E / (4 (1 + nu)), D1 = 6 (1 - 2 nu) / E
    EXPECT_TRUE(holds(deck, "*HYPERELASTIC, NEO HOOKE\n0.00185185185185, 180\n"));
    EXPECT_TRUE(holds(deck, "*STEP, NLGEOM\n"));
    EXPECT_FALSE(holds(deck, "*ELASTIC"));
}

TEST(WriteModel, RefusesALawThatAProgramHasNot) {
    RecoveredModel model = two_tet_model();
    model.law = TissueLaw{"neo-hookean"};
    EXPECT_THROW(abaqus_deck(model, WallLoad::displacement), Error);
    model.law = TissueLaw{"neo-hookean-reduced"};
    EXPECT_THROW(febio_model(model, WallLoad::displacement), Error);
}

TEST(GmshMesh, HasOneEntityPerRegion) {
    const std::string mesh = gmsh_mesh(two_tet_model());

    EXPECT_TRUE(holds(mesh, "$Elements\n2 2 1 2\n3 1 4 1\n1 1 2 3 4\n3 2 4 1\n2 2 5 3 4\n"));
    EXPECT_TRUE(holds(mesh, "3 2 \"prostate_peripheral_zone\"\n"));
}

TEST_F(WriteModelFile, AsVtuHasTheRatiosBesideTheModuli) {
    write_model(two_tet_model(), WallLoad::displacement, folder / "model.vtu");

    MeshArrays arrays;
    const Mesh mesh = read_vtu(folder / "model.vtu", "region", &arrays);

    EXPECT_EQ(mesh.region, (std::vector<Index>{0, 5}));
    EXPECT_EQ(arrays.cell_scalars.at("stiffness_kpa"), (std::vector<double>{10, 60}));
    EXPECT_EQ(arrays.cell_scalars.at("poisson_ratio"), (std::vector<double>{0.35, 0.4}));
    EXPECT_EQ(names_in(folder), "model.vtu");
}

TEST_F(WriteModelFile, RefusesOtherEndings) {
    EXPECT_THROW(write_model(two_tet_model(), WallLoad::force, folder / "model.stl"), Error);
    EXPECT_EQ(names_in(folder), "");
}

}  // namespace
}  // namespace palpate
