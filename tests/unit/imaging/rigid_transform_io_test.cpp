// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/imaging/nifti_bytes.hpp"
#include "tests/unit/imaging/voxelised.hpp"

namespace palpate {
namespace {

using namespace testing;

std::string transform_file(const std::string& type, const std::string& parameters,
                           const std::string& fixed) {
    return "#Insight Transform File V1.0\n#Transform 0\nTransform: " + type +
           "\nParameters: " + parameters + "\nFixedParameters: " + fixed + "\n";
}

TEST(RigidTransform, GivesBackWhatWasWritten) {
    const ScratchFolder folder;
    const RigidTransform transform{oblique_direction(), Vec3(1.5, -20.25, 300)};
    for (const char* name : {"t.tfm", "t.txt", "t.h5"}) {
        write_rigid_transform(folder / name, transform);
        const RigidTransform read = read_rigid_transform(folder / name);

        EXPECT_LT((read.rotation - transform.rotation).norm(), 1e-9) << name;
        EXPECT_LT((read.translation - transform.translation).norm(), 1e-9) << name;
    }
}

TEST(RigidTransform, TakesPointsTheWayItkDoes) {
    // ITK: y = R (x - c) + c + t. A quarter turn about z round c = (1, 0, 0), then t = (0, 0, 5).
    const ScratchFolder folder;
    save(folder / "euler.tfm",
         transform_file("Euler3DTransform_double_3_3", "0 0 1.5707963267948966 0 0 5", "1 0 0 0"));

    const RigidTransform t = read_rigid_transform(folder / "euler.tfm");

    EXPECT_LT((t.apply(Vec3(3, 0, 0)) - Vec3(1, 2, 5)).norm(), 1e-9);
    EXPECT_LT((t.inverse().apply(Vec3(1, 2, 5)) - Vec3(3, 0, 0)).norm(), 1e-9);
}

TEST(RigidTransform, AcceptsTranslationsVersorsAndRotatingAffines) {
    const ScratchFolder folder;
    save(folder / "a.tfm", transform_file("TranslationTransform_double_3_3", "1 2 3", ""));
    save(folder / "b.tfm",
         transform_file("AffineTransform_double_3_3", "0 -1 0 1 0 0 0 0 1 4 5 6", "0 0 0"));
    save(folder / "c.tfm", transform_file("VersorRigid3DTransform_double_3_3",
                                          "0 0 0.7071067811865476 4 5 6", "0 0 0"));

    EXPECT_TRUE(
        read_rigid_transform(folder / "a.tfm").apply(Vec3(1, 1, 1)).isApprox(Vec3(2, 3, 4)));
    EXPECT_TRUE(
        read_rigid_transform(folder / "b.tfm").apply(Vec3(1, 0, 0)).isApprox(Vec3(4, 6, 6)));
    EXPECT_TRUE(
        read_rigid_transform(folder / "c.tfm").apply(Vec3(1, 0, 0)).isApprox(Vec3(4, 6, 6)));
}

TEST(RigidTransform, RefusesWhatIsNotRigid) {
    const ScratchFolder folder;
    auto refuse = [&](const char* name, const std::string& content, ErrorCode code) {
        SCOPED_TRACE(name);
        save(folder / name, content);
        try {
            read_rigid_transform(folder / name);
            ADD_FAILURE() << "accepted";
        } catch (const Error& error) {
            EXPECT_EQ(int(error.code()), int(code)) << error.what();
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
        }
    };
    const auto affine = [](const std::string& p) {
        return transform_file("AffineTransform_double_3_3", p, "0 0 0");
    };
    refuse("scaled.tfm", affine("2 0 0 0 2 0 0 0 2 0 0 0"), ErrorCode::input_unusable);
    refuse("mirrored.tfm", affine("-1 0 0 0 1 0 0 0 1 0 0 0"), ErrorCode::input_unusable);
    refuse("plane.tfm", transform_file("Euler2DTransform_double_2_2", "0.1 1 2", "0 0"),
           ErrorCode::input_unusable);
    for (const char* numbers : {"0 0 0 1 2", "", "0 0 0 1 2 3 4"})
        refuse("cut.tfm", transform_file("VersorRigid3DTransform_double_3_3", numbers, "0 0 0"),
               ErrorCode::input_unreadable);
    refuse("text.tfm", "hello\n", ErrorCode::input_unreadable);
    refuse("empty.h5", "", ErrorCode::input_unreadable);
    refuse("ending.xyz", "", ErrorCode::input_unreadable);
    EXPECT_THROW(read_rigid_transform(folder / "missing.tfm"), Error);
}

}  // namespace
}  // namespace palpate
