// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/elements/tet4.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

namespace palpate {
namespace {

constexpr double rounding = 1e-13;

const std::array<Vec3, 4> corner = {Vec3(1, 2, 0), Vec3(9, 2.5, -1), Vec3(2, 8, 1), Vec3(0, 3, 7)};

Tet4 irregular_tet() { return tet4_geometry(corner[0], corner[1], corner[2], corner[3]); }

TEST(Tet4, HasTheGradientsOfTheUnitTetrahedron) {
    const Tet4 tet = tet4_geometry({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});

    EXPECT_EQ(tet.volume, 1.0 / 6);
    EXPECT_EQ(tet.gradient[0], Vec3(-1, -1, -1));
    EXPECT_EQ(tet.gradient[1], Vec3(1, 0, 0));
    EXPECT_EQ(tet.gradient[2], Vec3(0, 1, 0));
    EXPECT_EQ(tet.gradient[3], Vec3(0, 0, 1));
}

TEST(Tet4, ReproducesALinearFunction) {
    const Tet4 tet = irregular_tet();
    const Vec3 slope(0.3, -2, 1.5);

    Vec3 gradient = Vec3::Zero();
    for (int a = 0; a < 4; ++a) gradient += tet.gradient[a] * (4 + slope.dot(corner[a]));

    EXPECT_LT((gradient - slope).norm(), rounding);
}

TEST(Tet4, HasTheStiffnessOfStrainTimesHookeTimesStrain) {
    const Tet4 tet = irregular_tet();
    const double lambda = 3, mu = 2;
    Eigen::Matrix<double, 6, 12> strain = Eigen::Matrix<double, 6, 12>::Zero();
    for (int a = 0; a < 4; ++a) {
        const Vec3& g = tet.gradient[a];
        strain.middleCols<3>(3 * a) << g.x(), 0, 0, 0, g.y(), 0, 0, 0, g.z(), g.y(), g.x(), 0, 0,
            g.z(), g.y(), g.z(), 0, g.x();
    }
    Eigen::Matrix<double, 6, 6> hooke = Eigen::Matrix<double, 6, 6>::Zero();
    hooke.topLeftCorner<3, 3>().setConstant(lambda);
    hooke.diagonal() << lambda + 2 * mu, lambda + 2 * mu, lambda + 2 * mu, mu, mu, mu;
    const Tet4Stiffness expected = tet.volume * strain.transpose() * hooke * strain;

    EXPECT_LT((tet4_stiffness(tet, lambda, mu) - expected).norm(), rounding * expected.norm());
}

TEST(Tet4, ResistsEverythingButSixRigidMotions) {
    const Tet4Stiffness stiffness = tet4_stiffness(irregular_tet(), 3, 2);

    EXPECT_LT((stiffness - stiffness.transpose()).norm(), rounding * stiffness.norm());
    const auto values = Eigen::SelfAdjointEigenSolver<Tet4Stiffness>(stiffness).eigenvalues();
    EXPECT_LT(values.head<6>().cwiseAbs().maxCoeff(), rounding * values[11]);
    EXPECT_GT(values[6], 1e-3 * values[11]);
}

}  // namespace
}  // namespace palpate
