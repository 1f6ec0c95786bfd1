// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/shown_picture.hpp"

#include <gtest/gtest.h>

#include <random>

#include "host/apps/recover/report/html_report.hpp"
#include "host/apps/recover/report/static_slices.hpp"
#include "tests/unit/report/holds.hpp"
#include "tests/unit/report/synthetic_result.hpp"
#include "tests/unit/report/unpacked.hpp"

namespace palpate {
namespace {

/// Noise, which packs badly, in voxels of 0.5 mm.
Image<float> noise_image() {
    Image<float> image;
    image.grid.size = {280, 280, 60};
    image.grid.spacing = Vec3(0.5, 0.5, 3);
    image.grid.origin = Vec3(-70, -70, -90);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> grey(0, 1000);
    for (std::size_t v = 0; v < image.grid.num_voxels(); ++v) image.voxels.push_back(grey(random));
    return image;
}

TEST(ShownPicture, KeepsToItsBudgetEvenForNoise) {
    const LabelVolumes volumes = label_volumes(synthetic_result());
    const Image<float> image = noise_image();

    const ShownPicture picture = shown_picture(image, volumes, {}, {0, 1000});
    const ShownPicture small = shown_picture(image, volumes, {}, {0, 1000}, 50'000);

    EXPECT_LE(picture.mosaic.size(), picture_budget_bytes);
    EXPECT_GT(picture.mosaic.size(), picture_budget_bytes / 2);
    EXPECT_LE(small.mosaic.size(), 50'000u);
    EXPECT_EQ(small.grey.size[2], picture.grey.size[2]);
}

TEST(ShownPicture, TilesHoldTheSlicesInOrder) {
    const LabelVolumes volumes = label_volumes(synthetic_result());

    const ShownPicture picture = shown_picture(noise_image(), volumes, {}, {0, 1000}, 100'000);
    const GreyPixels mosaic = from_png(from_base64(picture.mosaic));

    const auto [columns, rows, slices] = picture.grey.size;
    ASSERT_EQ(mosaic.width, columns * picture.tiles_per_row);
    EXPECT_GT(picture.tiles_per_row, 1);
    for (Index k = 0; k < slices; ++k)
        for (Index j = 0; j < rows; j += 7)
            for (Index i = 0; i < columns; i += 7)
                ASSERT_EQ(mosaic.at(columns * (k % picture.tiles_per_row) + i,
                                    rows * (k / picture.tiles_per_row) + j),
                          picture.grey.voxels[picture.grey.offset(i, j, k)]);
}

TEST(ShownPictures, CarryTheReferenceImageByTheAlignmentAndLeaveTheTargets) {
    const RecoveryResult result = synthetic_result();
    const LabelVolumes volumes = label_volumes(result);
    const Image<float> image = noise_image();

    const ShownPictures pictures = shown_pictures({&image, &image}, result, volumes);

    const RigidTransform back = result.alignment.reference_to_target.inverse();
    const GreyWindow window = pictures.target.grey.window;
    EXPECT_EQ(pictures.target.mosaic, shown_picture(image, volumes, {}, window).mosaic);
    EXPECT_EQ(pictures.reference.mosaic, shown_picture(image, volumes, back, window).mosaic);
    EXPECT_TRUE(shown_pictures({}, result, volumes).empty());
}

/// A result and an image whose only organ voxel and only bright voxel are the same.
struct BrightDot {
    RecoveryResult result;
    Image<float> image;

    BrightDot() {
        result.regions.push_back({2,
                                  "dot",
                                  7,
                                  Role::tissue,
                                  false,
                                  true,
                                  0.4,
                                  50,
                                  {40, 60},
                                  0.1,
                                  Verdict::recovered,
                                  ""});
        ImageGrid grid;
        grid.size = {9, 10, 11};
        grid.spacing = Vec3(1, 2, 4);
        grid.direction = Vec3(-1, 1, 1).asDiagonal();
        result.reference_labels = {grid, std::vector<std::uint16_t>(grid.num_voxels(), 0)};
        result.reference_labels.at(2, 3, 4) = 7;
        result.target_labels_aligned = result.warped_labels = result.reference_labels;
        image = {grid, std::vector<float>(grid.num_voxels(), 0)};
        image.at(2, 3, 4) = 100;
    }
};

/// The pixel of the picture in a static slice that is bright; fails if there are several.
std::array<int, 2> bright_pixel(const std::string& svg) {
    const std::string mark = "base64,";
    const std::size_t at = svg.find(mark) + mark.size();
    const GreyPixels pixels = from_png(from_base64(svg.substr(at, svg.find('\'', at) - at)));
    std::array<int, 2> found{-1, -1};
    int count = 0;
    for (int row = 0; row < pixels.height; ++row)
        for (int column = 0; column < pixels.width; ++column)
            if (pixels.at(column, row) > 200) found = {column, row}, ++count;
    EXPECT_EQ(count, 1);
    return found;
}

TEST(StaticSlices, LayOutlinesOnTheSamePlaceOfThePicture) {
    const BrightDot dot;
    const LabelVolumes volumes = label_volumes(dot.result);
    const ShownPictures pictures = shown_pictures({nullptr, &dot.image}, dot.result, volumes);

    for (const SliceView view : {SliceView::axial, SliceView::coronal, SliceView::sagittal}) {
        const std::string plain = static_slice_svg(dot.result, volumes, view);
        const std::string on_image =
            static_slice_svg(dot.result, volumes, view, pictures, SliceGround::target);

        const auto [column, row] = bright_pixel(on_image);
        const std::string area =
            "M" + std::to_string(column) + " " + std::to_string(row) + "h1v1h-1z";
        EXPECT_TRUE(holds(plain, area)) << area << " in " << plain;
        EXPECT_FALSE(holds(on_image, area)) << "the organ is covered";
        EXPECT_TRUE(holds(on_image, "class='target-line'"));
    }
}

TEST(StaticSlices, ShowOnTheReferenceImageItsOwnOutlinesOnly) {
    const BrightDot dot;
    const LabelVolumes volumes = label_volumes(dot.result);
    const ShownPictures pictures = shown_pictures({&dot.image, nullptr}, dot.result, volumes);

    const std::string svg =
        static_slice_svg(dot.result, volumes, SliceView::axial, pictures, SliceGround::reference);

    EXPECT_TRUE(holds(svg, "class='warped-line'"));
    EXPECT_FALSE(holds(svg, "class='target-line'"));
}

TEST(HtmlReport, ShowsImagesOnlyIfTheyAreGivenAndStaysSmall) {
    const RecoveryResult result = synthetic_result();
    const Image<float> image = noise_image();

    const std::string without = html_report(result);
    const std::string one = html_report(result, false, {nullptr, &image});
    const std::string with = html_report(result, false, {&image, &image});

    EXPECT_FALSE(holds(without, "image/png;base64,iVBOR"));
    EXPECT_FALSE(holds(without, "On the target image"));
    EXPECT_TRUE(holds(with, "image/png;base64,iVBOR"));
    EXPECT_TRUE(holds(with, "On the target image"));
    EXPECT_TRUE(holds(with, "On the reference image"));
    EXPECT_TRUE(holds(with, "Axial<span class='ground'>, target image</span>"));
    EXPECT_TRUE(holds(with, " on-paper' style="));
    EXPECT_LT(one.size(), without.size() + 1'200'000);
    EXPECT_LT(with.size(), without.size() + 2'300'000);
}

TEST(HtmlReport, LeavesOutAnImageThatShowsNothingOfTheSlices) {
    const RecoveryResult result = synthetic_result();
    Image<float> image = noise_image();
    image.grid.origin += Vec3(2000, 0, 0);

    const std::string page = html_report(result, false, {nullptr, &image});

    EXPECT_FALSE(holds(page, "On the target image"));
    EXPECT_TRUE(holds(page, "Tinted areas: reference."));
}

}  // namespace
}  // namespace palpate
