// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/pelvis.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "host/geometry/meshing/rasterise.hpp"
#include "host/geometry/warping/warp_volume.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

PelvisPhantom make_small_pelvis(unsigned seed, Index num_nodes, const Vec3& spacing) {
    PelvisOptions options;
    options.seed = seed;
    options.num_nodes = num_nodes;
    options.spacing = spacing;
    return make_pelvis(options, {}, {});
}

Index label_at(const LabelImage& image, const Vec3& x) {
    const Vec3 index = image.grid.to_index(x);
    return image.at(Index(std::lround(index[0])), Index(std::lround(index[1])),
                    Index(std::lround(index[2])));
}

std::map<Index, double> volumes_cm3(const LabelImage& image) {
    std::map<Index, double> volumes;
    for (const auto label : image.voxels) volumes[label] += image.grid.voxel_volume() / 1000;
    return volumes;
}

double dice(const LabelImage& a, const LabelImage& b, Index label) {
    double in_a = 0, in_b = 0, in_both = 0;
    for (std::size_t v = 0; v < a.voxels.size(); ++v) {
        in_a += a.voxels[v] == label;
        in_b += b.voxels[v] == label;
        in_both += a.voxels[v] == label && b.voxels[v] == label;
    }
    return 2 * in_both / (in_a + in_b);
}

/// Smallest distance between voxels of two labels, less one voxel: the gap between the organs.
double smallest_gap(const LabelImage& image, Index a, Index b) {
    constexpr Index reach = 3;
    double smallest = 1e9;
    const auto& n = image.grid.size;
    for (Index k = reach; k < n[2] - reach; ++k)
        for (Index j = reach; j < n[1] - reach; ++j)
            for (Index i = reach; i < n[0] - reach; ++i) {
                if (image.at(i, j, k) != a) continue;
                for (Index dk = -reach; dk <= reach; ++dk)
                    for (Index dj = -reach; dj <= reach; ++dj)
                        for (Index di = -reach; di <= reach; ++di)
                            if (image.at(i + di, j + dj, k + dk) == b)
                                smallest = std::min(smallest, Vec3(di, dj, dk).norm() - 1);
            }
    return smallest;
}

/// One test body, because making a phantom takes a second or two.
TEST(Pelvis, HasOrgansLandmarksAndVolumesThatAgreeWithItsTrueDisplacement) {
    const PelvisPhantom phantom = make_small_pelvis(1, 5000, Vec3::Ones());

    for (const auto* image : {&phantom.reference, &phantom.target}) {
        auto volume = volumes_cm3(*image);
        EXPECT_GT(volume[1], 30);
        EXPECT_LT(volume[1], 65);
        for (const Index label : {2, 3, 4, 5}) {
            EXPECT_GT(volume[label], 5) << label;
            EXPECT_LT(volume[label], 120) << label;
        }
        EXPECT_EQ(volume.size(), 6u);
    }
    for (const auto& [a, b] : {std::pair{1, 2}, {1, 3}, {2, 3}, {1, 4}, {1, 5}}) {
        EXPECT_GE(smallest_gap(phantom.reference, a, b), 1.5) << a << ' ' << b;
    }

    ASSERT_EQ(phantom.landmarks.size(), 200u);
    for (std::size_t n = 0; n < phantom.landmarks.size(); ++n) {
        const Vec3& x = phantom.landmarks[n];
        EXPECT_EQ(label_at(phantom.reference, x), 1);
        EXPECT_EQ(label_at(phantom.target, x + phantom.landmark_displacements[n]), 1);
    }

    const Image<Vec3> u =
        displacement_on_grid(phantom.mesh.mesh, phantom.displacement, phantom.reference.grid);
    const LabelImage warped =
        warp_labels(phantom.reference, {u, true}, phantom.target.grid, Interpolation::nearest)
            .image;
    // Both volumes place a wall to a quarter voxel; of 17 cm^3 within 55 cm^2 that is some 3 %.
    const std::array<double, 6> least_dice{0.99, 0.97, 0.97, 0.955, 0.99, 0.99};
    for (const Index label : {0, 1, 2, 3, 4, 5}) {
        EXPECT_GE(dice(warped, phantom.target, label), least_dice[label]) << label;
    }
    for (const Index label : {1, 2, 3}) {
        EXPECT_LT(dice(phantom.reference, phantom.target, label), 0.95) << label;
    }
    EXPECT_GT(phantom.truth.smallest_jacobian, 0.2);
    EXPECT_GT(phantom.truth.prostate_mean_displacement_mm, 1.5);
    EXPECT_GT(phantom.truth.walls.at(0).resultant_force_mn.norm(), 500);
}

TEST(Pelvis, IsTheSameForTheSameSeed) {
    const Vec3 spacing(1, 1, 3);
    const PelvisPhantom first = make_small_pelvis(2, 3500, spacing);
    const PelvisPhantom second = make_small_pelvis(2, 3500, spacing);

    EXPECT_EQ(first.reference.voxels, second.reference.voxels);
    EXPECT_EQ(first.target.voxels, second.target.voxels);
    EXPECT_EQ(first.displacement, second.displacement);
    EXPECT_EQ(first.landmarks, second.landmarks);
    EXPECT_EQ(first.reference.grid.spacing, spacing);
}

TEST(Pelvis, WithZonesHasTheSameProstateInTwoLabels) {
    PelvisOptions options;
    options.seed = 2;
    options.num_nodes = 5000;
    options.spacing = Vec3::Constant(2);
    const PelvisPhantom one = make_pelvis(options, {}, {});
    options.zone_stiffness_kpa = {200.0, 50.0};

    const PelvisPhantom two = make_pelvis(options, {}, {});

    EXPECT_EQ(two.settings.organs[0].name, "peripheral_zone");
    EXPECT_EQ(two.settings.organs.back().name, "transition_zone");
    EXPECT_FALSE(two.settings.organs.back().stiffness_kpa.has_value());
    auto volume = volumes_cm3(two.reference), whole = volumes_cm3(one.reference);
    EXPECT_GT(volume[6], 0.2 * whole[1]);
    EXPECT_GT(volume[1], 0.4 * whole[1]);
    EXPECT_NEAR(volume[1] + volume[6], whole[1], 0.03 * whole[1]);
    EXPECT_EQ(two.landmarks.size(), 200u);
}

TEST(Pelvis, StandsStillWithoutLoad) {
    PelvisOptions options;
    options.seed = 2;
    options.num_nodes = 5000;
    options.spacing = Vec3::Constant(2);
    options.load_factor = 0;

    const PelvisPhantom still = make_pelvis(options, {}, {});

    EXPECT_EQ(still.reference.voxels, still.target.voxels);
    EXPECT_EQ(still.truth.peak_displacement_mm, 0);
    EXPECT_EQ(still.truth.walls.at(0).resultant_force_mn.norm(), 0);
}

TEST(Pelvis, MovesOneReferenceUnderSeveralLoads) {
    PelvisOptions options;
    options.seed = 4;
    options.num_nodes = 5000;
    options.spacing = Vec3::Constant(2);
    options.load = LoadFamily::drawn;
    options.contours = contour_error_of("matern32:0.5:7");
    std::vector<PelvisPhantom> made;

    make_pelvis_loads(options, 3, {}, {}, [&](const PelvisPhantom& one) { made.push_back(one); });

    ASSERT_EQ(made.size(), 3u);
    const PelvisPhantom alone = make_pelvis(options, {}, {});
    EXPECT_EQ(made[0].target.voxels, alone.target.voxels);
    EXPECT_EQ(made[0].truth.load_family, drawn_for(LoadFamily::drawn, options.seed));
    for (unsigned k = 0; k < 3; ++k) {
        EXPECT_EQ(made[k].truth.load, k + 1);
        EXPECT_EQ(made[k].reference.voxels, alone.reference.voxels);
        EXPECT_EQ(made[k].landmarks, alone.landmarks);
        ASSERT_EQ(made[k].landmark_displacements.size(), alone.landmarks.size());
        EXPECT_EQ(made[k].truth.walls.size(), 2u);
        EXPECT_GT(made[k].truth.peak_displacement_mm, 0.5);
    }
    for (unsigned k = 1; k < 3; ++k) {
        EXPECT_NE(made[k].truth.walls[0].shift_mm, made[0].truth.walls[0].shift_mm);
        EXPECT_LT(dice(made[k].target, made[0].target, 1), 0.99);
    }
}

TEST(Pelvis, DrawsTheContoursOfEachTargetAnew) {
    PelvisOptions options;
    options.seed = 4;
    options.num_nodes = 5000;
    options.spacing = Vec3::Constant(2);
    options.load_factor = 0;
    options.contours = contour_error_of("matern32:0.5:7");
    std::vector<std::vector<std::uint16_t>> drawn;

    make_pelvis_loads(options, 2, {}, {}, [&](const PelvisPhantom& one) {
        drawn.push_back(one.reference.voxels);
        drawn.push_back(one.target.voxels);
    });

    EXPECT_EQ(drawn.at(0), drawn.at(2));
    EXPECT_NE(drawn.at(0), drawn.at(1));
    EXPECT_NE(drawn.at(1), drawn.at(3));
    EXPECT_NE(drawn.at(0), drawn.at(3));
}

TEST(Pelvis, RefusesOptionsOutOfRange) {
    PelvisOptions options;
    options.stiffness_kpa = 0;
    EXPECT_THROW(make_pelvis(options, {}, {}), Error);
    options = {};
    options.poisson_ratio = 0.5;
    EXPECT_THROW(make_pelvis(options, {}, {}), Error);
    options = {};
    options.spacing[1] = 0;
    EXPECT_THROW(make_pelvis(options, {}, {}), Error);
    options = {};
    options.zone_stiffness_kpa = {50.0, 0.0};
    EXPECT_THROW(make_pelvis(options, {}, {}), Error);
    options.zone_stiffness_kpa = {50.0, 60.0};
    options.tumour_fraction = 0.1;
    EXPECT_THROW(make_pelvis(options, {}, {}), Error);
}

}  // namespace
}  // namespace palpate
