// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/result_folder.hpp"

#include <set>

#include "host/geometry/meshing/mesh_files.hpp"
#include "host/io/output_folder.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"
#include "solver/base/locked_folder.hpp"
#include "tests/unit/report/holds.hpp"
#include "tests/unit/report/synthetic_result.hpp"
#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {
namespace {

class ResultFolder : public TemporaryFolderTest {
protected:
    /// The message with which `action` fails; it must be Error(output_failed).
    template <typename Action>
    static std::string refusal(const Action& action) {
        try {
            action();
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::output_failed);
            return e.what();
        }
        return "no error";
    }
    static void write_note(const std::filesystem::path& inside) {
        write_text_file(inside / "result.json", "{}\n");
    }
};

TEST_F(ResultFolder, HoldsEveryFileAfterAWrite) {
    const RecoveryResult result = synthetic_result();

    write_result(result, folder / "out");

    EXPECT_EQ(names_in(folder), "out");
    EXPECT_EQ(names_in(folder / "out"),
              "convergence.csv displacement.nii.gz displacement_inverse.nii.gz mesh.vtu "
              "report.html result.json warped_labels.nii.gz");
}

TEST_F(ResultFolder, HoldsTheFieldsThatWereChosenAndItsJsonNamesThem) {
    ResultOptions options;
    options.fields = FieldChoice::none;
    write_result(synthetic_result(), folder / "none", options);
    options.fields = FieldChoice::all;
    write_result(synthetic_result(), folder / "all", options);

    EXPECT_EQ(names_in(folder / "none"),
              "convergence.csv mesh.vtu report.html result.json warped_labels.nii.gz");
    EXPECT_EQ(names_in(folder / "all"),
              "convergence.csv displacement.nii.gz displacement_inverse.nii.gz "
              "from-reference_to-target_mode-image_xfm.h5 "
              "from-target_to-reference_mode-image_xfm.h5 mesh.vtu report.html result.json "
              "warped_labels.nii.gz");
    const std::string none = content_of(folder / "none" / "result.json"),
                      all = content_of(folder / "all" / "result.json");
    EXPECT_TRUE(holds(none, "\"displacement_field\": null"));
    EXPECT_TRUE(holds(none, "\"itk_transform\": null"));
    EXPECT_TRUE(holds(all, "\"displacement_field\": \"displacement_inverse.nii.gz\""));
    EXPECT_TRUE(holds(all, "\"itk_transform\": \"from-target_to-reference_mode-image_xfm.h5\""));
}

TEST_F(ResultFolder, MeshFileHoldsFileLabelsAndFields) {
    const RecoveryResult result = synthetic_result();
    write_result(result, folder / "out");

    MeshArrays arrays;
    const Mesh mesh = read_vtu(folder / "out" / "mesh.vtu", "region", &arrays);

    ASSERT_EQ(mesh.num_nodes(), result.mesh.num_nodes());
    EXPECT_EQ(std::set<Index>(mesh.region.begin(), mesh.region.end()),
              (std::set<Index>{1, 2, 3, 4, 6}));
    EXPECT_EQ(arrays.cell_scalars.at("stiffness_kpa"), result.element_stiffness_kpa);
    EXPECT_LT((arrays.point_vectors.at("displacement")[70] - result.displacement[70]).norm(), 1e-6);
    EXPECT_LT((arrays.point_vectors.at("force")[3000] - result.force[3000]).norm(), 1e-6);
}

TEST_F(ResultFolder, LabelFileIsReadBackTheSame) {
    const RecoveryResult result = synthetic_result();
    write_result(result, folder / "out");

    const LabelImage labels = read_label_image(folder / "out" / "warped_labels.nii.gz");

    EXPECT_EQ(labels.voxels, result.warped_labels.voxels);
}

TEST_F(ResultFolder, NamesNoInputFileAndNoFolderOfThisMachine) {
    write_result(synthetic_result(), folder / "out");

    for (const auto& entry : std::filesystem::directory_iterator(folder / "out")) {
        EXPECT_FALSE(holds(content_of(entry.path()), "SECRETPATIENT")) << entry.path();
        EXPECT_FALSE(holds(content_of(entry.path()), folder.string())) << entry.path();
    }
}

TEST_F(ResultFolder, ThatExistsIsRefused) {
    std::filesystem::create_directory(folder / "out");

    const std::string message = refusal([&] { write_result(synthetic_result(), folder / "out"); });

    EXPECT_TRUE(holds(message, "exists already")) << message;
    EXPECT_TRUE(holds(message, "--overwrite")) << message;
    EXPECT_EQ(names_in(folder / "out"), "");
    EXPECT_EQ(names_in(folder), "out");
}

TEST_F(ResultFolder, IsReplacedWhenThatIsAsked) {
    write_folder_atomically(folder / "out", false, [](const auto& inside) {
        write_note(inside);
        write_text_file(inside / "old.txt", "old");
    });

    write_folder_atomically(folder / "out", true, write_note);

    EXPECT_EQ(names_in(folder), "out");
    EXPECT_EQ(names_in(folder / "out"), "result.json");
}

TEST_F(ResultFolder, WithoutAResultIsNeverReplaced) {
    std::filesystem::create_directory(folder / "thesis");
    std::ofstream(folder / "thesis" / "chapter.txt") << "years of work";

    const std::string message = refusal([&] { check_result_folder(folder / "thesis", true); });

    ResultOptions over_it;
    over_it.overwrite = true;

    EXPECT_TRUE(holds(message, "no result of palpate")) << message;
    EXPECT_THROW(write_result(synthetic_result(), folder / "thesis", over_it), Error);
    EXPECT_EQ(content_of(folder / "thesis" / "chapter.txt"), "years of work");
}

TEST_F(ResultFolder, FailureInTheMiddleLeavesNothing) {
    const auto half = [](const std::filesystem::path& inside) {
        write_note(inside);
        throw Error(ErrorCode::output_failed, "disk full");
    };

    EXPECT_EQ(refusal([&] { write_folder_atomically(folder / "a" / "b" / "out", false, half); }),
              "disk full");

    EXPECT_EQ(names_in(folder), "");
}

TEST_F(ResultFolder, FailureInTheMiddleNamesTheFolderThatWasAskedFor) {
    const auto nowhere = [](const std::filesystem::path& inside) {
        write_field(inside / "no" / "field.h5", synthetic_result().displacement_field);
    };

    const std::string message =
        refusal([&] { write_folder_atomically(folder / "out", false, nowhere); });

    EXPECT_TRUE(holds(message, "cannot write '" + (folder / "out/no/field.h5").string() + "'"));
    EXPECT_TRUE(holds(message, "there is no folder '" + (folder / "out/no").string() + "'"));
    EXPECT_FALSE(holds(message, "unfinished")) << message;
}

TEST_F(ResultFolder, FailureWhileReplacingKeepsTheOldOne) {
    write_folder_atomically(folder / "out", false, write_note);

    EXPECT_THROW(write_folder_atomically(folder / "out", true,
                                         [](const auto&) { throw std::runtime_error("broken"); }),
                 std::runtime_error);

    EXPECT_EQ(names_in(folder), "out");
    EXPECT_EQ(content_of(folder / "out" / "result.json"), "{}\n");
}

TEST_F(ResultFolder, ThatSomebodyElseMadeMeanwhileIsNotTouched) {
    const auto slow = [&](const std::filesystem::path& inside) {
        write_note(inside);
        std::filesystem::create_directory(folder / "out");
    };

    EXPECT_NE(refusal([&] { write_folder_atomically(folder / "out", false, slow); }), "no error");
    EXPECT_EQ(names_in(folder), "out");
    EXPECT_EQ(names_in(folder / "out"), "");
}

TEST_F(ResultFolder, ParentsAreMadeAndATrailingSlashIsFine) {
    write_folder_atomically(folder / "a" / "b" / "out/", false, write_note);

    EXPECT_EQ(names_in(folder / "a" / "b"), "out");
}

TEST_F(ResultFolder, InsideAFileIsRefused) {
    std::ofstream(folder / "file") << "x";

    EXPECT_NE(refusal([&] { check_result_folder(folder / "file" / "out", false); }), "no error");
    EXPECT_NE(refusal([&] { write_folder_atomically(folder / "file" / "out", false, write_note); }),
              "no error");
}

TEST_F(ResultFolder, InAFolderWithoutWritePermissionIsRefused) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere; the /proc test stands in";
    std::filesystem::permissions(
        folder, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);

    EXPECT_TRUE(holds(refusal([&] { check_result_folder(folder / "out", false); }), "written to"));

    std::filesystem::permissions(folder, std::filesystem::perms::owner_all);
}

TEST_F(ResultFolder, WhereTheSystemForbidsItIsRefused) {
    const std::string message =
        refusal([&] { write_folder_atomically("/proc/palpate_result", false, write_note); });

    EXPECT_TRUE(holds(message, "/proc/palpate_result")) << message;
    EXPECT_TRUE(holds(message, "--out")) << message;
}

TEST_F(ResultFolder, OfSeveralTargetsIsUsedAgainOnlyWhenAskedAndKeepsWhatIsNotItsOwn) {
    write_targets_files(folder / "out", "first\n", "<p>first");
    std::ofstream(folder / "out" / "notes.txt") << "mine";
    std::filesystem::create_directories(folder / "out" / "two" / "of somebody");
    const auto check = [&](const std::vector<std::string>& names, bool overwrite) {
        return refusal([&] { check_targets_folder(folder / "out", names, overwrite); });
    };

    write_targets_files(folder / "out", "second\n", "<p>second");

    EXPECT_TRUE(holds(check({"one"}, false), "--overwrite"));
    EXPECT_EQ(check({"one"}, true), "no error");
    EXPECT_TRUE(holds(check({"one", "two"}, true), "no result.json"));
    EXPECT_EQ(content_of(folder / "out" / "targets.csv"), "second\n");
    EXPECT_EQ(names_in(folder / "out"), "notes.txt targets.csv targets.html two");
}

TEST_F(ResultFolder, AnEmptyFolderIsReplacedWhenAskedBecauseThereIsNothingToLose) {
    std::filesystem::create_directory(folder / "out");
    EXPECT_TRUE(holds(refusal([&] { check_result_folder(folder / "out", false); }), "--overwrite"));
    EXPECT_EQ(refusal([&] { check_result_folder(folder / "out", true); }), "no error");
}

TEST_F(ResultFolder, RemovesWhatAKilledRunLeftBehindButNotWhatAnotherOneWrites) {
    std::filesystem::create_directories(folder / ".out.unfinished-0badcafe" / "deep");
    std::filesystem::create_directories(folder / ".other.unfinished-0badcafe");
    const LockedFolder of_another(folder, ".out.unfinished-", LockedFolder::Readers::everybody);

    write_folder_atomically(folder / "out", false, write_note);

    EXPECT_FALSE(std::filesystem::exists(folder / ".out.unfinished-0badcafe"));
    EXPECT_TRUE(std::filesystem::exists(folder / ".other.unfinished-0badcafe"));
    EXPECT_TRUE(std::filesystem::exists(of_another.path()));
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / "result.json"));
}

TEST_F(ResultFolder, OfOneTargetIsNotTakenForSeveral) {
    write_folder_atomically(folder / "out", false, write_note);

    EXPECT_TRUE(holds(refusal([&] { check_targets_folder(folder / "out", {"one"}, true); }),
                      "no targets.csv"));
}

}  // namespace
}  // namespace palpate
