// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/imaging/nifti_bytes.hpp"
#include "tests/unit/imaging/voxelised.hpp"

namespace palpate {
namespace {

using namespace testing;

/// Labels that no flip or exchange of axes leaves unchanged.
LabelImage asymmetric_image(const Mat3& direction, std::uint16_t largest) {
    LabelImage image;
    image.grid.size = {5, 4, 3};
    image.grid.spacing = Vec3(0.7, 1.1, 2.3);
    image.grid.origin = Vec3(-31.5, 12.25, 7.125);
    image.grid.direction = direction;
    for (std::size_t n = 0; n < image.grid.num_voxels(); ++n) {
        image.voxels.push_back(std::uint16_t(n * n * largest / (59 * 59)));
    }
    return image;
}

void expect_same(const LabelImage& a, const LabelImage& b, double tolerance) {
    EXPECT_EQ(a.grid.size, b.grid.size);
    EXPECT_EQ(a.voxels, b.voxels);
    EXPECT_LT((a.grid.origin - b.grid.origin).norm(), tolerance);
    EXPECT_LT((a.grid.spacing - b.grid.spacing).norm(), tolerance);
    EXPECT_LT((a.grid.direction - b.grid.direction).norm(), tolerance);
}

TEST(ReadLabelImage, GivesBackWhatWasWrittenInEveryFormatAndDirection) {
    const ScratchFolder folder;
    for (const char* name : {"a.nii", "b.nii.gz", "c.nrrd", "d.mha"}) {
        for (const Mat3& direction :
             {Mat3(Mat3::Identity()), oblique_direction(), left_handed_direction()}) {
            for (std::uint16_t largest : {255, 65535}) {
                const LabelImage image = asymmetric_image(direction, largest);

                write_label_image(folder / name, image);
                const LabelImage read = read_label_image(folder / name);

                SCOPED_TRACE(name);
                expect_same(read, image, 1e-5);
            }
        }
    }
}

TEST(ReadLabelImage, TurnsTheRasOfNiftiIntoLps) {
    const ScratchFolder folder;
    save(folder / "a.nii", good_nifti());

    const LabelImage image = read_label_image(folder / "a.nii");

    EXPECT_EQ(image.grid.size, (std::array<Index, 3>{4, 3, 2}));
    EXPECT_TRUE(image.grid.spacing.isApprox(Vec3(2, 3, 4)));
    EXPECT_TRUE(image.grid.origin.isApprox(Vec3(-10, 20, 30)));
    EXPECT_TRUE(image.grid.direction.isApprox(Vec3(-1, -1, 1).asDiagonal().toDenseMatrix()));
    EXPECT_EQ(image.at(1, 2, 1), 1 + 4 * (2 + 3 * 1));
    // Voxel (1, 2, 1) is at RAS (10 + 2, -20 + 6, 30 + 4).
    EXPECT_TRUE(image.grid.to_point(Vec3(1, 2, 1)).isApprox(Vec3(-12, 14, 34)));
}

TEST(ReadLabelImage, UsesTheQformAloneWithItsQuaternionAndLeftHandedFactor) {
    const ScratchFolder folder;
    Bytes bytes = good_nifti();
    put<std::int16_t>(bytes, 254, 0);
    put(bytes, 76, -1.0f);                             // qfac: third axis reversed
    put(bytes, 264, float(std::sin(0.5 * M_PI / 2)));  // a quarter turn about S
    save(folder / "a.nii", bytes);

    const LabelImage image = read_label_image(folder / "a.nii");

    // RAS: i axis along +A, j axis along -R, k axis along -S; LPS turns the signs of R and A.
    Mat3 expected;
    expected.col(0) = Vec3(0, -1, 0);
    expected.col(1) = Vec3(1, 0, 0);
    expected.col(2) = Vec3(0, 0, -1);
    EXPECT_LT((image.grid.direction - expected).norm(), 1e-6);
    EXPECT_TRUE(image.grid.origin.isApprox(Vec3(-10, 20, 30)));
}

TEST(ReadLabelImage, PrefersTheSformWhereBothDiffer) {
    const ScratchFolder folder;
    Bytes bytes = good_nifti();
    put(bytes, 268, 99.0f);  // of the qform
    save(folder / "a.nii", bytes);

    std::vector<std::string> warnings;
    const LabelImage image = read_label_image(folder / "a.nii", {}, &warnings);

    EXPECT_TRUE(image.grid.origin.isApprox(Vec3(-10, 20, 30)));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("the sform was used"), std::string::npos);
}

TEST(ReadLabelImage, StopsWhereItsSinkThrows) {
    const ScratchFolder folder;
    save(folder / "a.nii", good_nifti());
    const auto cancel = [](const Progress&) { throw Error(ErrorCode::cancelled, "enough"); };

    EXPECT_THROW(read_label_image(folder / "a.nii", cancel), Error);
}

TEST(ReadLabelImage, ReadsTheOtherByteOrderAndFloatingPointLabels) {
    const ScratchFolder folder;
    Bytes bytes = good_nifti();
    put<std::int16_t>(bytes, 70, 16);
    put<std::int16_t>(bytes, 72, 32);
    bytes.resize(352 + 96);
    for (int n = 0; n < 24; ++n) put(bytes, 352 + 4 * n, float(3 * n));
    auto reverse = [&](std::size_t offset, std::size_t width) {
        std::reverse(bytes.begin() + offset, bytes.begin() + offset + width);
    };
    reverse(0, 4);
    for (int n = 0; n < 8; ++n) reverse(40 + 2 * n, 2), reverse(76 + 4 * n, 4);
    for (std::size_t offset : {68, 70, 72, 252, 254}) reverse(offset, 2);
    for (std::size_t offset : {108, 112, 116}) reverse(offset, 4);
    for (int n = 0; n < 18; ++n) reverse(256 + 4 * n, 4);
    for (int n = 0; n < 24; ++n) reverse(352 + 4 * n, 4);
    save(folder / "a.nii", bytes);

    const LabelImage image = read_label_image(folder / "a.nii");

    EXPECT_EQ(image.at(1, 2, 1), 3 * (1 + 4 * (2 + 3 * 1)));
    EXPECT_TRUE(image.grid.origin.isApprox(Vec3(-10, 20, 30)));
}

TEST(ReadLabelImage, IsNotMisledByATwinFile) {
    const ScratchFolder folder;
    Bytes other = good_nifti();
    std::fill(other.begin() + 352, other.end(), std::uint8_t(7));
    save(folder / "a.nii", other);
    save(folder / "a.nii.gz", gzipped(good_nifti()));

    EXPECT_EQ(read_label_image(folder / "a.nii.gz").voxels[23], 23);
    EXPECT_EQ(read_label_image(folder / "a.nii").voxels[23], 7);
}

TEST(ReadLabelImage, ReadsAGzipFileOfSeveralMembers) {
    const ScratchFolder folder;
    const Bytes good = good_nifti();
    Bytes first = gzipped(Bytes(good.begin(), good.begin() + 200));
    const Bytes second = gzipped(Bytes(good.begin() + 200, good.end()));
    first.insert(first.end(), second.begin(), second.end());
    save(folder / "a.nii.gz", first);

    EXPECT_EQ(read_label_image(folder / "a.nii.gz").voxels[23], 23);
}

TEST(ReadLabelImage, TurnsTheSpaceOfNrrdIntoLps) {
    const ScratchFolder folder;
    for (const char* space : {"right-anterior-superior", "left-posterior-superior"}) {
        std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nspace: ";
        text += space;
        text +=
            "\nsizes: 4 3 2\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nkinds: domain domain "
            "domain\nendian: little\nencoding: raw\nspace origin: (10,-20,30)\n\n";
        for (char n = 0; n < 24; ++n) text += n;
        save(folder / "a.nrrd", text);

        const LabelImage image = read_label_image(folder / "a.nrrd");

        const double sign = space[0] == 'r' ? -1 : 1;
        EXPECT_TRUE(image.grid.origin.isApprox(Vec3(10 * sign, -20 * sign, 30))) << space;
        EXPECT_TRUE(image.grid.direction.isApprox(Vec3(sign, sign, 1).asDiagonal().toDenseMatrix()))
            << space;
        EXPECT_EQ(image.at(1, 2, 1), 1 + 4 * (2 + 3 * 1));
    }
}

TEST(ReadLabelImage, ReadsDetachedDataBesideTheHeader) {
    const ScratchFolder folder;
    Bytes voxels;
    for (std::uint8_t n = 0; n < 24; ++n) voxels.push_back(n);
    std::filesystem::create_directory(folder / "data");
    save(folder / "v.raw", voxels);
    save(folder / "data/v.raw", voxels);
    save(folder / "a.nhdr", std::string("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\n"
                                        "spacings: 2 3 4\nencoding: raw\ndata file: v.raw\n"));
    save(folder / "a.mhd", std::string("NDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\n"
                                       "ElementSpacing = 2 3 4\nElementDataFile = data/v.raw\n"));

    EXPECT_EQ(read_label_image(folder / "a.nhdr").voxels[23], 23);
    EXPECT_EQ(read_label_image(folder / "a.mhd").voxels[23], 23);
}

std::filesystem::path data_folder() {
    const char* folder = std::getenv("PALPATE_DATA");
    return folder ? folder : "";
}

TEST(ReadLabelImage, PlacesTheObliquePelvisAsItsHeaderSays) {
    const auto path = data_folder() / "pelvis_mr_pair_prostatex0001" / "reference_labels.nii.gz";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real data: set PALPATE_DATA";
    const Bytes header = gunzipped(load_bytes(path), 352);

    const LabelImage image = read_label_image(path);

    ASSERT_EQ(image.grid.size, (std::array<Index, 3>{384, 384, 19}));
    for (const Vec3& index : {Vec3(0, 0, 0), Vec3(383, 0, 0), Vec3(0, 383, 0), Vec3(0, 0, 18)}) {
        Vec3 expected;
        for (int r = 0; r < 3; ++r) {
            const std::size_t row = 280 + 16 * r;
            expected[r] = get<float>(header, row + 12);
            for (int c = 0; c < 3; ++c) expected[r] += get<float>(header, row + 4 * c) * index[c];
        }
        expected.head<2>() *= -1;
        EXPECT_LT((image.grid.to_point(index) - expected).norm(), 1e-3);
    }
    EXPECT_GT(std::abs(image.grid.direction(1, 2)), 0.05) << "the acquisition is tilted";
    // Volume of the bladder from the data's description.
    const auto bladder = std::count(image.voxels.begin(), image.voxels.end(), 1);
    EXPECT_NEAR(double(bladder) * image.grid.voxel_volume() / 1000, 69.3, 0.1);
}

TEST(ReadLabelImage, ReadsGlandsThatHaveOnlyAQform) {
    const auto folder = data_folder() / "prostate_mr_two_visits_picai";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real data: set PALPATE_DATA";

    const LabelImage gland = read_label_image(folder / "10153_1000155_gland.nii.gz");
    const LabelImage zones = read_label_image(folder / "10153_1000155_zones.nii.gz");

    EXPECT_LT((gland.grid.origin - zones.grid.origin).norm(), 0.01);
    EXPECT_LT((gland.grid.direction - zones.grid.direction).norm(), 1e-4);
    EXPECT_GT(std::count(gland.voxels.begin(), gland.voxels.end(), 1), 1000);
}

TEST(ReadLabelImage, ReadsACompressedMetaImage) {
    const auto path = data_folder() / "lung_ct_pair_elastix" / "baseline_lung_mask.mha";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no real data: set PALPATE_DATA";

    const LabelImage image = read_label_image(path);

    EXPECT_EQ(image.grid.size, (std::array<Index, 3>{115, 157, 129}));
    EXPECT_TRUE(image.grid.origin.isApprox(Vec3(-153.827, -150.352, -1434.5)));
    EXPECT_TRUE(image.grid.spacing.isApprox(Vec3(1.366, 1.366, 2.5)));
}

}  // namespace
}  // namespace palpate
