// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/landmarks.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::filesystem::path written(const PrivateFolder& folder, const char* name, const char* text) {
    std::ofstream(folder.path() / name) << text;
    return folder.path() / name;
}

TEST(Landmarks, ErrorsAreThoseOfTheAlignmentAndOfTheField) {
    Image<Vec3> field;
    field.grid.size = {5, 5, 5};
    field.voxels.assign(field.grid.num_voxels(), Vec3(1, 2, 0));
    RigidTransform shift;
    shift.translation = Vec3(1, 0, 0);
    const auto results = measure_landmarks(
        {{Vec3(2, 2, 2), Vec3(3, 4, 2.5)}, {Vec3(99, 2, 2), Vec3(100, 4, 2)}}, field, shift);
    EXPECT_NEAR(results[0].error_mm_before, std::hypot(2, 0.5), 1e-12);
    EXPECT_NEAR(results[0].error_mm_after, 0.5, 1e-12);
    EXPECT_TRUE(results[0].is_inside);
    EXPECT_FALSE(results[1].is_inside);
}

TEST(Landmarks, FilesAreMatchedRowByRowAndByName) {
    const PrivateFolder folder;
    const auto reference = written(folder, "a.csv", "name,x,y,z\napex,1,2,3\nbase,4,5,6\n");
    const auto target = written(folder, "b.csv", "x,y,z,Name\n1,2,4,apex\n4,5,8,base\n");
    const auto lps = read_landmarks(reference, target, PointAxes::lps);
    ASSERT_EQ(lps.size(), 2u);
    EXPECT_EQ(lps[1].target, Vec3(4, 5, 8));
    EXPECT_EQ(read_landmarks(reference, target, PointAxes::ras)[1].target, Vec3(-4, -5, 8));
}

TEST(Landmarks, FilesThatDoNotMatchAreRefused) {
    const PrivateFolder folder;
    const auto two = written(folder, "a.csv", "name,x,y,z\napex,1,2,3\nbase,4,5,6\n");
    for (const char* other : {"name,x,y,z\napex,1,2,3\n", "name,x,y,z\nbase,1,2,3\napex,4,5,6\n"}) {
        const auto path = written(folder, "b.csv", other);
        try {
            read_landmarks(two, path, PointAxes::lps);
            ADD_FAILURE() << "accepted " << other;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::input_unusable);
        }
    }
}

}  // namespace
}  // namespace palpate
