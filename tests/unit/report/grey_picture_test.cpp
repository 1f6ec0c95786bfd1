// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/grey_picture.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

constexpr std::size_t many = 10'000'000;

/// Another slope along each axis, so that a flip or an exchange of axes is seen.
double number_at(const Vec3& x) { return 1000 + 1.0 * x.x() + 2.3 * x.y() - 0.7 * x.z(); }

/// A volume of `number_at` on an oblique, anisotropic grid that reaches beyond the organs.
Image<float> slope_image(bool left_handed = false) {
    Image<float> image;
    image.grid.size = {61, 90, 45};
    image.grid.spacing = Vec3(5, 2.6, 6.5);
    image.grid.direction =
        (Eigen::AngleAxisd(0.4, Vec3::UnitZ()) * Eigen::AngleAxisd(-0.3, Vec3::UnitX()) *
         Eigen::AngleAxisd(std::acos(-1.0), Vec3::UnitY()))
            .toRotationMatrix();
    if (left_handed) image.grid.direction.col(1) *= -1;
    const Vec3 middle(30, 45, 22);
    image.grid.origin = -(image.grid.direction * middle.cwiseProduct(image.grid.spacing));
    for (Index k = 0; k < image.grid.size[2]; ++k)
        for (Index j = 0; j < image.grid.size[1]; ++j)
            for (Index i = 0; i < image.grid.size[0]; ++i)
                image.voxels.push_back(float(number_at(image.grid.to_point(Vec3(i, j, k)))));
    return image;
}

/// In its own window.
GreyPicture shown_all(const Image<float>& image, const LabelVolumes& volumes,
                      const RigidTransform& to_image, std::size_t max_voxels) {
    return grey_picture(image, volumes, to_image, grey_window(image, volumes, to_image),
                        max_voxels);
}

/// LPS mm of the centre of a voxel of a picture of these volumes.
Vec3 point_of(const GreyPicture& picture, const LabelVolumes& volumes, Index i, Index j, Index k) {
    Vec3 along;
    const std::array<Index, 3> at{i, j, k};
    for (int a = 0; a < 3; ++a)
        along[a] = ((at[a] + 0.5) / picture.size[a] * volumes.size[a] - 0.5) * volumes.spacing[a];
    return volumes.origin + volumes.axes * along;
}

void expect_numbers_of_slope(const GreyPicture& picture, const LabelVolumes& volumes,
                             const RigidTransform& to_image) {
    const double level = (picture.window.white - picture.window.black) / 255;
    for (Index k = 0; k < picture.size[2]; k += 3)
        for (Index j = 0; j < picture.size[1]; j += 5)
            for (Index i = 0; i < picture.size[0]; i += 5) {
                const Vec3 x = to_image.apply(point_of(picture, volumes, i, j, k));
                const int expected = picture.window.grey(number_at(x));
                ASSERT_NEAR(picture.voxels[picture.offset(i, j, k)], expected, 1)
                    << i << ' ' << j << ' ' << k << ", a level is " << level;
            }
}

TEST(GreyPicture, ShowsEveryNumberWhereItLies) {
    const LabelVolumes volumes = label_volumes(synthetic_result());

    const GreyPicture picture = shown_all(slope_image(), volumes, {}, many);

    EXPECT_GT(picture.window.white, picture.window.black + 50);
    expect_numbers_of_slope(picture, volumes, {});
}

TEST(GreyPicture, ShowsALeftHandedImageWhereItLies) {
    const LabelVolumes volumes = label_volumes(synthetic_result());
    const Image<float> image = slope_image(true);
    ASSERT_NEAR(image.grid.direction.determinant(), -1, 1e-12);

    expect_numbers_of_slope(shown_all(image, volumes, {}, many), volumes, {});
}

TEST(GreyPicture, FollowsTheRigidTransform) {
    const LabelVolumes volumes = label_volumes(synthetic_result());
    const RigidTransform turned{Eigen::AngleAxisd(0.2, Vec3(1, 2, 3).normalized()).matrix(),
                                Vec3(9, -4, 6)};

    const GreyPicture picture = shown_all(slope_image(), volumes, turned, many);

    expect_numbers_of_slope(picture, volumes, turned);
}

TEST(GreyPicture, TakesTheVoxelsOfAnImageOnTheSameGridAsTheyAre) {
    const RecoveryResult result = synthetic_result();
    const LabelVolumes volumes = label_volumes(result);
    Image<float> image{result.target_labels_aligned.grid, {}};
    for (const std::uint16_t label : result.target_labels_aligned.voxels)
        image.voxels.push_back(label == 3 ? 700.f : 100.f);

    const GreyPicture picture = shown_all(image, volumes, {}, many);

    ASSERT_EQ(picture.size, volumes.size);
    constexpr int bladder = 3;
    for (std::size_t v = 0; v < picture.voxels.size(); ++v)
        ASSERT_EQ(picture.voxels[v], volumes.target[v] == bladder ? 255 : 0);
}

double spread_of(const GreyPicture& picture) {
    double sum = 0, squares = 0;
    for (const double grey : picture.voxels) {
        sum += grey;
        squares += grey * grey;
    }
    const double count = double(picture.voxels.size());
    return std::sqrt(squares / count - sum / count * (sum / count));
}

TEST(GreyPicture, CoarsensTheFinestAxesAndTakesMeans) {
    const LabelVolumes volumes = label_volumes(synthetic_result());
    Image<float> image = slope_image();
    image.grid.spacing = Vec3(1, 1, 9);
    image.grid.direction = Mat3::Identity();
    image.grid.size = {200, 200, 20};
    image.grid.origin = Vec3(-100, -100, -90);
    image.voxels.clear();
    std::mt19937 random(3);
    std::normal_distribution<float> noise(500, 100);
    for (std::size_t v = 0; v < image.grid.num_voxels(); ++v) image.voxels.push_back(noise(random));
    const GreyWindow window{0, 1000};

    const GreyPicture fine = grey_picture(image, volumes, {}, window, many);
    const GreyPicture coarse = grey_picture(image, volumes, {}, window, fine.voxels.size() / 10);

    EXPECT_LE(coarse.voxels.size(), fine.voxels.size() / 10);
    EXPECT_EQ(coarse.size[2], fine.size[2]);
    EXPECT_LT(coarse.size[0], 0.4 * fine.size[0]);
    EXPECT_LT(spread_of(coarse), 0.6 * spread_of(fine));  // chosen voxels would keep theirs
}

TEST(GreyPicture, IsBlackBeyondTheImageAndEmptyWhereThereIsNone) {
    const LabelVolumes volumes = label_volumes(synthetic_result());
    Image<float> image = slope_image();
    image.grid.origin += Vec3(150, 0, 0);  // shows the patient's left half

    const GreyPicture half = shown_all(image, volumes, {}, many);
    image.grid.origin += Vec3(1000, 0, 0);
    const GreyPicture none = shown_all(image, volumes, {}, many);

    ASSERT_FALSE(half.empty());
    const Index j = half.size[1] / 2, k = half.size[2] / 2;
    EXPECT_EQ(half.voxels[half.offset(0, j, k)], 0);
    EXPECT_GT(half.voxels[half.offset(half.size[0] - 1, j, k)], 0);
    EXPECT_TRUE(none.empty());
}

Image<float> with_numbers(std::vector<float> numbers) {
    Image<float> image;
    image.grid.size = {Index(numbers.size()), 1, 1};
    image.voxels = std::move(numbers);
    return image;
}

TEST(GreyWindow, LeavesOutSomeHundredthsAtBothEnds) {
    std::vector<float> numbers;
    for (int i = 0; i <= 1000; ++i) numbers.push_back(float(i));
    numbers.back() = 1e6f;  // one bright voxel
    numbers.push_back(std::nanf(""));

    const GreyWindow window = grey_window(with_numbers({0, 1000}), numbers);

    EXPECT_NEAR(window.black, 10, 1);
    EXPECT_NEAR(window.white, 980, 1);
    EXPECT_EQ(window.grey(-5), 0);
    EXPECT_EQ(window.grey(1e6), 255);
    EXPECT_EQ(window.grey(495), 128);
}

TEST(GreyWindow, IsThatOfSoftTissueOrLungForHounsfieldUnits) {
    std::vector<float> abdomen(1000, 40.f), chest(1000, -800.f);
    std::fill(abdomen.begin(), abdomen.begin() + 100, -1000.f);  // air round the patient, bowel
    std::fill(chest.begin(), chest.begin() + 500, 40.f);
    std::fill(chest.begin(), chest.begin() + 100, -1000.f);

    EXPECT_EQ(grey_window(with_numbers(abdomen), abdomen).white, 240);
    EXPECT_EQ(grey_window(with_numbers(abdomen), abdomen).black, -160);
    EXPECT_EQ(grey_window(with_numbers(chest), chest).white, 150);
}

template <typename Distribution>
std::vector<float> drawn(Distribution distribution, bool whole = true) {
    std::mt19937 random(11);
    std::vector<float> numbers(20'000);
    for (float& number : numbers) number = float(distribution(random));
    if (whole)
        for (float& number : numbers) number = std::round(number);
    return numbers;
}

/// What a scanner would show of a trunk in air.
std::vector<float> trunk_in_air() {
    const std::vector<float> air = drawn(std::normal_distribution<>(-1000, 15)),
                             fat = drawn(std::normal_distribution<>(-100, 20)),
                             organs = drawn(std::normal_distribution<>(50, 20)),
                             bone = drawn(std::uniform_real_distribution<>(200, 1400));
    std::vector<float> numbers;
    for (std::size_t n = 0; n < air.size(); ++n)
        numbers.push_back(n % 10 < 4   ? air[n]
                          : n % 10 < 6 ? fat[n]
                          : n % 10 < 9 ? organs[n]
                                       : bone[n]);
    return numbers;
}

bool is_soft_tissue_or_lung(const std::vector<float>& numbers) {
    const GreyWindow window = grey_window(with_numbers(numbers), numbers);
    return (window.black == -160 && window.white == 240) ||
           (window.black == -1350 && window.white == 150);
}

TEST(GreyWindow, RecognisesCtByWholeNumbersAirAndSoftTissue) {
    std::vector<float> ct = trunk_in_air();
    EXPECT_TRUE(is_soft_tissue_or_lung(ct));

    std::vector<float> padded = ct;  // beyond the scanner's circle
    std::fill(padded.begin(), padded.begin() + 4000, -3024.f);
    EXPECT_TRUE(is_soft_tissue_or_lung(padded));

    for (float& number : ct) number = (number + 1000) / 2400;
    EXPECT_FALSE(is_soft_tissue_or_lung(ct));
}

TEST(GreyWindow, TakesNothingElseForCt) {
    using Normal = std::normal_distribution<>;
    using Uniform = std::uniform_real_distribution<>;
    EXPECT_FALSE(is_soft_tissue_or_lung(drawn(Uniform(0, 4000)))) << "MR";
    EXPECT_FALSE(is_soft_tissue_or_lung(drawn(Normal(300, 400)))) << "MR with values below zero";
    EXPECT_FALSE(is_soft_tissue_or_lung(drawn(Uniform(-4096, 4095)))) << "phase";
    EXPECT_FALSE(is_soft_tissue_or_lung(drawn(Normal(0, 1), false))) << "z-scores";
    EXPECT_FALSE(is_soft_tissue_or_lung(drawn(Uniform(-1000, 1000)))) << "noise";
    EXPECT_FALSE(is_soft_tissue_or_lung(drawn(Normal(0, 400)))) << "normal noise";
    EXPECT_FALSE(is_soft_tissue_or_lung(drawn(Normal(40, 30)))) << "CT inside the body";
    std::vector<float> scaled = trunk_in_air();
    for (float& number : scaled) number += 0.37f;
    EXPECT_FALSE(is_soft_tissue_or_lung(scaled)) << "fractions";
}

TEST(GreyWindow, IsSharedByImagesThatAreMuchAlike) {
    GreyWindow a{20, 800}, b{30, 680}, mr{0, 300}, ct{-160, 240};

    share_window(a, b);
    share_window(mr, ct);

    EXPECT_EQ(a.black, 20);
    EXPECT_EQ(b.white, 800);
    EXPECT_EQ(mr.white, 300);
    EXPECT_EQ(ct.black, -160);
}

TEST(GreyWindow, OfAlmostOneNumberShowsTheOthers) {
    std::vector<float> numbers(1000, 5.f);
    const GreyWindow constant = grey_window(with_numbers(numbers), numbers);
    numbers.back() = 6;

    const GreyWindow window = grey_window(with_numbers(numbers), numbers);

    EXPECT_EQ(constant.grey(5), 0);
    EXPECT_EQ(window.grey(5), 0);
    EXPECT_EQ(window.grey(6), 255);
}

}  // namespace
}  // namespace palpate
