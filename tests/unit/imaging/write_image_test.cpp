// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>

#include "host/io/displacement_steps.hpp"
#include "host/io/gzip.hpp"
#include "host/io/preflight.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/imaging/nifti_bytes.hpp"
#include "tests/unit/imaging/voxelised.hpp"

namespace palpate {
namespace {

using namespace testing;

Image<Vec3> vector_image() {
    Image<Vec3> image;
    image.grid.size = {4, 3, 2};
    image.grid.spacing = Vec3(2, 3, 4);
    image.grid.origin = Vec3(10, -20, 30);
    image.grid.direction = oblique_direction();
    for (int n = 0; n < 24; ++n) image.voxels.emplace_back(n, -2 * n, 0.5 * n);
    return image;
}

TEST(WriteVectorImage, IsFiveDimensionalNiftiWithVectorIntent) {
    const ScratchFolder folder;

    write_vector_image(folder / "u.nii.gz", vector_image());

    const Bytes bytes = gunzipped(load_bytes(folder / "u.nii.gz"), 100000);
    const std::int16_t dim[8] = {5, 4, 3, 2, 1, 3, 1, 1};
    for (int n = 0; n < 8; ++n) EXPECT_EQ(get<std::int16_t>(bytes, 40 + 2 * n), dim[n]) << n;
    EXPECT_EQ(get<std::int16_t>(bytes, 68), 1007);
    EXPECT_EQ(get<std::int16_t>(bytes, 70), 16);  // float
    EXPECT_EQ(bytes[123] & 7, 2);                 // mm
    EXPECT_GT(get<std::int16_t>(bytes, 252), 0);
    const auto offset = std::size_t(get<float>(bytes, 108));
    ASSERT_EQ(bytes.size(), offset + 24 * 3 * 4);
    for (int component = 0; component < 3; ++component) {
        for (int n = 0; n < 24; ++n) {  // one component after the other, LPS
            EXPECT_EQ(get<float>(bytes, offset + 4 * (24 * component + n)),
                      float(vector_image().voxels[n][component]));
        }
    }
}

TEST(WriteVectorImage, LiesWhereItsGridSays) {
    const ScratchFolder folder;
    const Image<Vec3> image = vector_image();

    write_vector_image(folder / "u.nii", image);

    const Bytes bytes = load_bytes(folder / "u.nii");
    for (const Vec3& index : {Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 2, 0), Vec3(0, 0, 1)}) {
        Vec3 ras;
        for (int r = 0; r < 3; ++r) {
            ras[r] = get<float>(bytes, 280 + 16 * r + 12);
            for (int c = 0; c < 3; ++c)
                ras[r] += get<float>(bytes, 280 + 16 * r + 4 * c) * index[c];
        }
        const Vec3 lps(-ras[0], -ras[1], ras[2]);
        EXPECT_LT((lps - image.grid.to_point(index)).norm(), 1e-4);
    }
}

TEST(WriteVectorImage, PlacesItselfTheSameInBothForms) {
    const ScratchFolder folder;
    Image<Vec3> image = vector_image();
    const Mat3 about_x = Eigen::AngleAxisd(3.0, Vec3::UnitX()).toRotationMatrix();
    for (const Mat3& direction : {Mat3(Mat3::Identity()), oblique_direction(),
                                  left_handed_direction(), Mat3(about_x * oblique_direction())}) {
        image.grid.direction = direction;
        write_vector_image(folder / "u.nii.gz", image);

        EXPECT_TRUE(preflight_vectors(folder / "u.nii.gz").warnings.empty());
        const ImageGrid grid = read_vector_image(folder / "u.nii.gz").grid;
        EXPECT_LT((grid.direction - direction).norm(), 1e-6);
        EXPECT_LT((grid.origin - image.grid.origin).norm(), 1e-4);
        Bytes bytes = gunzipped(load_bytes(folder / "u.nii.gz"), 100000);
        put<std::int16_t>(bytes, 254, 0);  // no sform
        save(folder / "q.nii", bytes);
        EXPECT_LT((read_vector_image(folder / "q.nii").grid.direction - direction).norm(), 1e-5);
    }
}

Image<Vec3> uneven_image() {
    Image<Vec3> image = vector_image();
    for (std::size_t n = 0; n < image.voxels.size(); ++n)
        image.voxels[n] = Vec3(std::sin(double(n)), -300 * std::cos(3.0 * double(n)), -1e-4);
    return image;
}

TEST(WriteDisplacement, RoundsToTheNearestStepAndSaysSo) {
    const ScratchFolder folder;
    const Image<Vec3> image = uneven_image();
    write_vector_image(folder / "u.nii.gz", image);
    write_displacement_transform(folder / "u.h5", image);

    const Image<Vec3> fields[] = {read_vector_image(folder / "u.nii.gz"),
                                  read_displacement_transform(folder / "u.h5")};
    for (const Image<Vec3>& field : fields) {
        ASSERT_EQ(field.voxels.size(), image.voxels.size());
        for (std::size_t n = 0; n < field.voxels.size(); ++n) {
            const Vec3 steps = field.voxels[n] * 128;
            EXPECT_EQ(steps, Vec3(steps.array().round()));
            EXPECT_LE((field.voxels[n] - image.voxels[n]).cwiseAbs().maxCoeff(), 1.0 / 256);
            EXPECT_FALSE(std::signbit(field.voxels[n][2]));  // no -0
        }
    }
    const Bytes header = gunzipped(load_bytes(folder / "u.nii.gz"), 100000);
    EXPECT_NE(std::string(&header[148], &header[228]).find("rounded to 1/128 mm"),
              std::string::npos);
}

TEST(WriteDisplacement, RefusesWhatIsNotFinite) {
    const ScratchFolder folder;
    Image<Vec3> image = vector_image();
    image.voxels[7][1] = std::numeric_limits<double>::quiet_NaN();

    EXPECT_THROW(write_vector_image(folder / "u.nii.gz", image), Error);
    EXPECT_THROW(write_displacement_transform(folder / "u.h5", image), Error);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Gzip, GivesBackWhatItWasGiven) {
    for (const std::size_t size : {0, 1, 1000, 3000000}) {
        Bytes bytes(size);
        for (std::size_t n = 0; n < size; ++n) bytes[n] = std::uint8_t(n * n / 7);

        const Bytes packed = palpate::gzipped(std::span<const std::uint8_t>(bytes));

        EXPECT_TRUE(is_gzip(packed));
        EXPECT_EQ(inflated(packed, size), bytes) << size;
    }
}

TEST(WriteImage, RefusesOtherFormats) {
    const ScratchFolder folder;
    LabelImage labels{vector_image().grid, std::vector<std::uint16_t>(24, 1)};

    EXPECT_THROW(write_vector_image(folder / "u.mha", vector_image()), Error);
    EXPECT_THROW(write_label_image(folder / "a.mhd", labels), Error);
    EXPECT_THROW(write_label_image(folder / "a.png", labels), Error);
    labels.voxels.pop_back();
    EXPECT_THROW(write_label_image(folder / "a.nii", labels), Error);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(WriteImage, TakesTheEndingInAnyCase) {
    const ScratchFolder folder;
    const LabelImage labels{vector_image().grid, std::vector<std::uint16_t>(24, 1)};
    for (const char* name : {"A.NII", "B.NII.GZ", "C.NRRD", "D.MHA", "e.Mha"}) {
        write_label_image(folder / name, labels);
        EXPECT_EQ(read_label_image(folder / name).voxels, labels.voxels) << name;
    }
}

TEST(WriteImage, SaysWhatToDoWithMoreVoxelsThanNiftiCounts) {
    ImageGrid grid;
    grid.size = {40000, 2, 2};
    try {
        write_label_image("long.nii", {grid, std::vector<std::uint16_t>(grid.num_voxels(), 1)});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::output_failed);
        for (const char* words : {"32767", "40000", ".nrrd", ".h5"})
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << words;
    }
}

TEST(WriteImage, SaysWhichFileCouldNotBeWritten) {
    const LabelImage labels{vector_image().grid, std::vector<std::uint16_t>(24, 1)};
    try {
        write_label_image("no-such-folder/a.nii.gz", labels);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::output_failed);
        EXPECT_NE(std::string(error.what()).find("no-such-folder/a.nii.gz"), std::string::npos);
    }
}

TEST(WriteImage, LeavesNoTemporaryFiles) {
    const ScratchFolder folder;
    write_label_image(folder / "a.nii.gz",
                      {vector_image().grid, std::vector<std::uint16_t>(24, 1)});

    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        EXPECT_EQ(entry.path().filename(), "a.nii.gz");
        ++count;
    }
    EXPECT_EQ(count, 1);
}

/// No file of this process gets longer, as on a full disk.
class ShortFiles {
public:
    explicit ShortFiles(rlim_t most_bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{most_bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~ShortFiles() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    ShortFiles(const ShortFiles&) = delete;
    ShortFiles& operator=(const ShortFiles&) = delete;

private:
    rlimit before_{};
    void (*handler_)(int);
};

TEST(WriteImage, RefusesToLeaveAFieldThatTheDiskCutOff) {
    const ScratchFolder folder;
    using Writer = void (*)(const std::filesystem::path&, const Image<Vec3>&);
    const std::pair<const char*, Writer> writers[] = {
        {"field.nii.gz", write_vector_image},
        {"field.nii", write_vector_image},
        {"field.h5", write_displacement_transform},
        {"labels.mha",
         [](const auto& path, const auto& image) {
             write_label_image(path, {image.grid, std::vector<std::uint16_t>(24, 1)});
         }},
    };
    for (const auto& [name, write] : writers) {
        for (const rlim_t most_bytes : {0, 100}) {
            const ShortFiles limit(most_bytes);
            try {
                write(folder / name, vector_image());
                ADD_FAILURE() << name << " within " << most_bytes << " bytes";
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::output_failed) << name << ' ' << most_bytes;
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
                EXPECT_EQ(std::string(error.what()).find("unfinished"), std::string::npos);
            }
            EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << name << ' ' << most_bytes;
        }
    }
}

}  // namespace
}  // namespace palpate
