// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/model.hpp"

#include <gtest/gtest.h>

#include "solver/base/error.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate {
namespace {

Model valid_model() {
    return fixtures::free_model(fixtures::box_mesh({1, 1, 1}, {1, 1, 1}), {{10.0, 0.35}});
}

void expect_refused(const Model& model, const std::string& word) {
    try {
        check_model(model);
        FAIL() << "accepted a model with a wrong " << word;
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
}

TEST(CheckModel, AcceptsAValidModel) { EXPECT_NO_THROW(check_model(valid_model())); }

TEST(CheckModel, RefusesAnEmptyMesh) { expect_refused(Model{}, "no elements"); }

TEST(CheckModel, RefusesMissingRegionNumbers) {
    Model model = valid_model();
    model.mesh.region.pop_back();
    expect_refused(model, "region numbers");
}

TEST(CheckModel, RefusesMissingPrescribedFlags) {
    Model model = valid_model();
    model.prescribed.pop_back();
    expect_refused(model, "prescribed");
}

TEST(CheckModel, RefusesANodeNumberOutsideTheMesh) {
    Model model = valid_model();
    model.mesh.tets[3][2] = model.mesh.num_nodes();
    expect_refused(model, "Tetrahedron 3 names node 8");
}

TEST(CheckModel, RefusesARegionWithoutMaterial) {
    Model model = valid_model();
    model.mesh.region[2] = 1;
    expect_refused(model, "region 1");
}

TEST(CheckModel, RefusesAnInvertedAndAFlatElement) {
    Model inverted = valid_model();
    std::swap(inverted.mesh.tets[4][0], inverted.mesh.tets[4][1]);
    expect_refused(inverted, "Tetrahedron 4 has volume");
    Model flat = valid_model();
    for (Vec3& p : flat.mesh.nodes) p.z() = 0;
    expect_refused(flat, "volume");
}

TEST(CheckModel, RefusesCoordinatesThatAreNotFinite) {
    Model model = valid_model();
    model.mesh.nodes[6].y() = std::numeric_limits<double>::quiet_NaN();
    expect_refused(model, "Node 6");
}

TEST(CheckModel, RefusesMaterialsOutsideTheirRange) {
    for (const LinearElastic material :
         {LinearElastic{0, 0.3}, LinearElastic{-1, 0.3},
          LinearElastic{std::numeric_limits<double>::quiet_NaN(), 0.3}}) {
        Model model = valid_model();
        model.materials[0] = material;
        expect_refused(model, "stiffness");
    }
    for (const LinearElastic material : {LinearElastic{1, 0.5}, LinearElastic{1, -1}}) {
        Model model = valid_model();
        model.materials[0] = material;
        expect_refused(model, "Poisson");
    }
}

}  // namespace
}  // namespace palpate
