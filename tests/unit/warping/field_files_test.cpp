// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/warping/field_files.hpp"

#include <itkTransform.h>
#include <itkTransformFileReader.h>

#include "host/io/transform_formats.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/report/temporary_folder.hpp"
#include "tests/unit/warping/oblique_scene.hpp"

namespace palpate {
namespace {

using namespace testing;

constexpr double same_mm = 1e-3;  // what is promised between palpate and ITK

class FieldFiles : public TemporaryFolderTest {
protected:
    void write_both() {
        for (const FieldFile& names : {forward_field, backward_field}) {
            const double sign = names.field == forward_field.field ? 1 : -0.5;
            const auto field = sampled(
                oblique_grid(), [&](const Vec3& x) { return Vec3(sign * smooth_displacement(x)); });
            write_fields(folder, names, field, FieldChoice::all);
        }
    }
    std::string refusal(const std::filesystem::path& path) {
        try {
            read_point_map(path, Sense::reference_to_target);
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    }
};

TEST_F(FieldFiles, MoveAThousandPointsInItkAsInPalpate) {
    write_both();
    register_transform_formats();
    for (const Sense sense : {Sense::reference_to_target, Sense::target_to_reference}) {
        const FieldFile& names =
            sense == Sense::reference_to_target ? forward_field : backward_field;
        const auto reader = itk::TransformFileReaderTemplate<double>::New();
        reader->SetFileName((folder / names.transform).string());
        reader->Update();
        const auto* transform = dynamic_cast<const itk::Transform<double, 3, 3>*>(
            reader->GetTransformList()->front().GetPointer());
        ASSERT_NE(transform, nullptr);
        const PointMap map = read_point_map(folder, sense);
        EXPECT_FALSE(map.inverted);

        double most = 0, moved = 0;
        for (const Vec3& x : points_in(map.field.grid, 1000, 0)) {
            itk::Point<double, 3> point;
            for (unsigned a = 0; a < 3; ++a) point[a] = x[a];
            const auto theirs = transform->TransformPoint(point);
            const Vec3 ours = map.moved(x).point;
            most = std::max(most, (ours - Vec3(theirs[0], theirs[1], theirs[2])).norm());
            moved = std::max(moved, (ours - x).norm());
        }
        EXPECT_LT(most, same_mm);
        EXPECT_GT(moved, 2);
    }
}

TEST_F(FieldFiles, HoldTheSameFieldInBothFormats) {
    write_both();

    const Image<Vec3> image = read_vector_image(folder / forward_field.field);
    const Image<Vec3> transform = read_displacement_transform(folder / forward_field.transform);

    ASSERT_EQ(image.voxels.size(), transform.voxels.size());
    for (std::size_t v = 0; v < image.voxels.size(); ++v) {
        ASSERT_EQ(image.voxels[v], transform.voxels[v]);
    }
    EXPECT_LT((image.grid.origin - transform.grid.origin).norm(), 1e-4);  // NIfTI has floats
    EXPECT_LT((image.grid.direction - transform.grid.direction).norm(), 1e-6);
    EXPECT_LT((transform.grid.origin - oblique_grid().origin).norm(), 1e-12);
    EXPECT_LT((transform.grid.spacing - oblique_grid().spacing).norm(), 1e-12);
}

TEST_F(FieldFiles, ASingleFieldIsInvertedForTheOtherSense) {
    write_both();
    const auto file = folder / forward_field.transform;

    const PointMap there = read_point_map(file, Sense::reference_to_target);
    const PointMap back = read_point_map(file, Sense::target_to_reference);

    for (const Vec3& x : points_in(there.field.grid, 100, 0.1)) {
        EXPECT_LT((back.moved(there.moved(x).point).point - x).norm(), same_mm);
    }
}

TEST_F(FieldFiles, AFolderWithoutTheInverseStillHasOne) {
    write_both();
    std::filesystem::remove(folder / backward_field.field);
    std::filesystem::remove(folder / backward_field.transform);

    EXPECT_TRUE(read_point_map(folder, Sense::target_to_reference).inverted);
    EXPECT_FALSE(read_point_map(folder, Sense::reference_to_target).inverted);
}

TEST_F(FieldFiles, OfASenseEitherFileWillDo) {
    write_both();
    for (const Sense sense : {Sense::reference_to_target, Sense::target_to_reference}) {
        const FieldFile& names =
            sense == Sense::reference_to_target ? forward_field : backward_field;
        const auto both = read_written_field(folder, sense);
        std::filesystem::remove(folder / names.field);
        EXPECT_EQ(read_written_field(folder, sense).voxels, both.voxels);
        EXPECT_FALSE(read_point_map(folder, sense).inverted);
    }
}

TEST_F(FieldFiles, TakeTheirEndingInAnyCase) {
    const auto field = sampled(oblique_grid(), smooth_displacement);
    for (const char* name : {"a.nii.gz", "a.h5", "B.NII.GZ", "B.H5", "c.Hdf5", "d.NII"}) {
        EXPECT_TRUE(is_field_file(folder / name)) << name;
        write_field(folder / name, field);
        EXPECT_EQ(read_written_field(folder / name, Sense::reference_to_target).voxels,
                  read_written_field(folder / "a.nii.gz", Sense::reference_to_target).voxels)
            << name;
    }
    const auto size = [&](const char* name) { return std::filesystem::file_size(folder / name); };
    EXPECT_EQ(size("B.NII.GZ"), size("a.nii.gz"));
    EXPECT_GT(size("d.NII"), size("a.nii.gz"));
    for (const char* name : {"a.png", "nii", "a.nii.png", "a.vtu"})
        EXPECT_FALSE(is_field_file(folder / name)) << name;
}

/// What a field may take on disk, smooth as the solver's are.
TEST_F(FieldFiles, StaySmall) {
    const auto field = sampled(oblique_grid({80, 70, 40}), smooth_displacement);
    const double voxels = double(field.voxels.size());  // of 12 bytes before rounding and packing

    write_fields(folder, forward_field, field, FieldChoice::all);

    EXPECT_LT(double(std::filesystem::file_size(folder / forward_field.field)), 4.5 * voxels);
    EXPECT_LT(double(std::filesystem::file_size(folder / forward_field.transform)), 6 * voxels);
}

TEST_F(FieldFiles, AreThoseThatWereChosen) {
    const auto field = sampled(oblique_grid(), smooth_displacement);

    write_fields(folder, forward_field, field, field_choice_of("none"));
    EXPECT_EQ(names_in(folder), "");
    write_fields(folder, forward_field, field, field_choice_of("one"));
    EXPECT_EQ(names_in(folder), "displacement.nii.gz");
    write_fields(folder, forward_field, field, field_choice_of("all"));
    EXPECT_EQ(names_in(folder), "displacement.nii.gz from-target_to-reference_mode-image_xfm.h5");
    EXPECT_THROW(field_choice_of("both"), Error);
}

TEST_F(FieldFiles, ThatWereNotWrittenAreMissedInASentence) {
    std::ofstream(folder / "result.json") << "{}";
    EXPECT_NE(refusal(folder).find("without --fields none"), std::string::npos);
    write_fields(folder, forward_field, sampled(oblique_grid(), smooth_displacement),
                 FieldChoice::one);
    EXPECT_EQ(refusal(folder), "no error");
    EXPECT_THROW(read_written_field(folder, Sense::target_to_reference), Error);
    EXPECT_THROW(read_written_field(folder / forward_field.field, Sense::target_to_reference),
                 Error);
}

TEST_F(FieldFiles, OtherFilesAreRefusedInASentence) {
    write_rigid_transform(folder / "rigid.h5", {});
    std::ofstream(folder / "text.h5") << "no HDF5 at all";
    write_scalar_image(folder / "scalar.nii.gz", {oblique_grid({4, 4, 4}), std::vector<float>(64)});

    EXPECT_NE(refusal(folder).find("displacement.nii.gz"), std::string::npos);
    EXPECT_NE(refusal(folder / "absent.h5").find("no such file"), std::string::npos);
    EXPECT_NE(refusal(folder / "rigid.h5").find("not a displacement field"), std::string::npos);
    EXPECT_NE(refusal(folder / "text.h5").find("text.h5"), std::string::npos);
    EXPECT_NE(refusal(folder / "scalar.nii.gz").find("five dimensions"), std::string::npos);
    EXPECT_NE(refusal(folder / "field.png").find("field.png"), std::string::npos);
}

}  // namespace
}  // namespace palpate
