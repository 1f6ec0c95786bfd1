// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/deformation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "solver/model/stiffness_matrix.hpp"
#include "solver/model/tet4_model.hpp"
#include "tests/unit/phantom/hollow_block.hpp"

namespace palpate {
namespace {

/// Two halves of 10 and 40 kPa.
Model two_halves() {
    Model model;
    const RegionMesh block =
        fixtures::region_block({4, 4, 4}, Vec3::Constant(20),
                               [](const Vec3& x) { return x.x() < 10 ? Index(0) : Index(1); }, {});
    model.mesh = block.mesh;
    model.materials = {{10, 0.3}, {40, 0.45}};
    model.prescribed.assign(static_cast<std::size_t>(model.num_dofs()), 0);
    return model;
}

Eigen::VectorXd moved_by(const Model& model, const Mat3& gradient) {
    Eigen::VectorXd u(model.num_dofs());
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        u.segment<3>(3 * n) = gradient * model.mesh.nodes[n];
    return u;
}

TEST(RegionDeformation, UniformStretchChangesVolumesByItsDeterminant) {
    const Model model = two_halves();
    Mat3 gradient = Mat3::Zero();
    gradient.diagonal() << 0.1, -0.05, 0.2;
    for (const auto& region :
         region_deformations(solid_model_of(model), TissueLaw{}, moved_by(model, gradient)))
        for (const double jacobian : region.jacobian_range)
            EXPECT_NEAR(jacobian, 1.1 * 0.95 * 1.2, 1e-12);
}

TEST(RegionDeformation, LinearEnergyIsHalfTheWorkOfTheForces) {
    const Model model = two_halves();
    const Eigen::VectorXd u = Eigen::VectorXd::Random(model.num_dofs());
    const StiffnessMatrix stiffness = assemble_stiffness(model);
    Eigen::VectorXd force(u.size());
    multiply_rows(stiffness, 0, stiffness.num_nodes(), u.data(), 1, {}, force.data());
    double energy = 0;
    for (const auto& region : region_deformations(solid_model_of(model), TissueLaw{}, u))
        energy += region.strain_energy_mj;
    EXPECT_NEAR(energy, 0.5 * u.dot(force) / 1000, 1e-10 * std::abs(energy));
}

TEST(RegionDeformation, EnergiesOfRegionsGoAsTheirModuli) {
    Model model = two_halves();
    model.materials[1].poisson_ratio = 0.3;
    Mat3 shear = Mat3::Zero();
    shear(0, 1) = 0.02;
    const auto regions =
        region_deformations(solid_model_of(model), TissueLaw{}, moved_by(model, shear));
    // mu/2 gamma^2 V of each half
    EXPECT_NEAR(regions[0].strain_energy_mj, 0.5 * 10 / 2.6 * 0.0004 * 4000 / 1000, 1e-9);
    EXPECT_NEAR(regions[1].strain_energy_mj, 4 * regions[0].strain_energy_mj, 1e-9);
}

TEST(RegionDeformation, LawsAgreeAtSmallStrainsAndARotationCostsTheFiniteOneNothing) {
    const Model model = two_halves();
    Mat3 gradient = 1e-5 * Mat3::Random();
    const auto small = moved_by(model, gradient);
    EXPECT_NEAR(
        region_deformations(solid_model_of(model), TissueLaw{"neo-hookean"}, small)[1]
            .strain_energy_mj,
        region_deformations(solid_model_of(model), TissueLaw{}, small)[1].strain_energy_mj,
        1e-4 * region_deformations(solid_model_of(model), TissueLaw{}, small)[1].strain_energy_mj);
    const Mat3 turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const auto turning = moved_by(model, turned - Mat3::Identity());
    EXPECT_NEAR(region_deformations(solid_model_of(model), TissueLaw{"neo-hookean"}, turning)[0]
                    .strain_energy_mj,
                0, 1e-10);
}

TEST(RegionDeformation, AnInvertedElementHasANegativeJacobianAndNoFiniteEnergy) {
    const Model model = two_halves();
    Mat3 mirrored = Mat3::Zero();
    mirrored(2, 2) = -2;
    const auto regions = region_deformations(solid_model_of(model), TissueLaw{"neo-hookean"},
                                             moved_by(model, mirrored));
    EXPECT_NEAR(regions[0].jacobian_range[0], -1, 1e-12);
    EXPECT_TRUE(std::isinf(regions[0].strain_energy_mj));
}

}  // namespace
}  // namespace palpate
