// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/slice_share.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace palpate {
namespace {

VoxelPlanes voxels(double height_mm) {
    VoxelPlanes planes;
    planes.spacing = Vec3(1, 1, height_mm);
    planes.smoothing_mm = 0.9;
    return planes;
}

/// Points some 3 mm apart on an upright tube of radius 15 and height 40 mm, two images alike.
std::vector<LinearRow> tube(double height_mm = 1) {
    std::vector<LinearRow> rows;
    for (int layer = 0; layer < 14; ++layer) {
        for (int k = 0; k < 30; ++k) {
            const double angle = 2 * std::numbers::pi * (k + 0.5 * (layer % 2)) / 30;
            const Vec3 normal(std::cos(angle), std::sin(angle), 0);
            LinearRow row;
            row.place = 15 * normal + Vec3(0, 0, 2.9 * layer + 0.3 * std::sin(3.0 * k));
            row.slices.fill(slice_place(voxels(height_mm), row.place, normal));
            rows.push_back(row);
        }
    }
    return rows;
}

using Kernel = std::function<double(const LinearRow&, const LinearRow&)>;

Eigen::MatrixXd covariance_of(const std::vector<LinearRow>& rows, const Kernel& kernel) {
    const Index n = static_cast<Index>(rows.size());
    Eigen::MatrixXd covariance(n, n);
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j) covariance(i, j) = kernel(rows[i], rows[j]);
    return covariance;
}

/// The mean share that contours drawn with this kernel show, voxels' own noise in them.
double mean_share(const Kernel& kernel, int draws = 10) {
    const std::vector<LinearRow> rows = tube();
    Eigen::MatrixXd covariance = 0.16 * covariance_of(rows, kernel);
    covariance.diagonal().array() += 0.1 * 0.1;
    const Eigen::MatrixXd root = covariance.llt().matrixL();
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    double sum = 0;
    for (int draw = 0; draw < draws; ++draw) {
        const Eigen::VectorXd white =
            Eigen::VectorXd::NullaryExpr(root.rows(), [&](Eigen::Index) { return normal(random); });
        sum += slice_share_of(rows, root * white);
    }
    return sum / draws;
}

double slices(const LinearRow& a, const LinearRow& b) {
    return slice_correlation(a.slices, b.slices, (a.place - b.place).norm());
}

TEST(SliceShare, IsLargeOfContoursDrawnSliceBySlice) { EXPECT_GT(mean_share(slices), 0.7); }

TEST(SliceShare, IsAboutHalfWhereHalfOfItIs) {
    const double share = mean_share([](const LinearRow& a, const LinearRow& b) {
        return 0.5 * slices(a, b) + 0.5 * contour_correlation((a.place - b.place).norm());
    });
    EXPECT_GT(share, 0.3);
    EXPECT_LT(share, 0.75);
}

TEST(SliceShare, IsNoneOfKernelsAlongTheSurfaceWhateverTheirLength) {
    for (const double length : {3.0, 7.0, 14.0}) {
        const auto matern = [&](const LinearRow& a, const LinearRow& b) {
            return contour_correlation((a.place - b.place).norm() * contour_length_mm / length);
        };
        EXPECT_LT(mean_share(matern), 0.1) << length;
    }
    const auto exponential = [](const LinearRow& a, const LinearRow& b) {
        return std::exp(-(a.place - b.place).norm() / 6);
    };
    EXPECT_LT(mean_share(exponential), 0.1);
}

TEST(SliceShare, TheKernelIsACovarianceAndOneOnUprightSurfaces) {
    const std::vector<LinearRow> rows = tube(3);
    const Eigen::MatrixXd covariance = covariance_of(rows, slices);
    EXPECT_NEAR(covariance.diagonal().minCoeff(), 1, 1e-12);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance, Eigen::EigenvaluesOnly)
                  .eigenvalues()
                  .minCoeff(),
              -1e-9);
}

TEST(SliceShare, SlicesLieAcrossTheLargestSpacingElseTheLastAxis) {
    const Vec3 place(1, 2, 3), normal(0, 1, 0);
    EXPECT_EQ(slice_place(voxels(1), place, normal).height_mm, 3);
    VoxelPlanes sagittal = voxels(1);
    sagittal.spacing = Vec3(3, 1, 1);
    const SlicePlace at = slice_place(sagittal, place, Vec3(1, 0, 0));
    EXPECT_EQ(at.height_mm, 1);
    EXPECT_EQ(at.inplane, Vec3(0, 0, 0));
    EXPECT_DOUBLE_EQ(at.range_mm, 0.9 + 1.5);
}

}  // namespace
}  // namespace palpate
