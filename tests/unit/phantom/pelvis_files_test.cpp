// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "host/apps/phantom/pelvis.hpp"
#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// A phantom of a few voxels, not computed: this is about the files.
PelvisPhantom tiny_phantom() {
    PelvisPhantom phantom;
    phantom.settings.background = BackgroundSettings{};
    phantom.settings.organs = {{"prostate", 1, Role::tissue, false, {}, 0.40},
                               {"bladder", 2, Role::driven, true, {}, 0.40}};
    ImageGrid grid;
    grid.size = {4, 3, 2};
    grid.origin = Vec3(-5, 7, 11);
    grid.spacing = Vec3(1, 1, 3);
    phantom.reference = {grid, std::vector<std::uint16_t>(24, 0)};
    phantom.reference.at(3, 0, 1) = 2;
    phantom.target = phantom.reference;
    phantom.target.at(0, 2, 0) = 1;
    phantom.landmarks = {Vec3(1, 2, 3)};
    phantom.landmark_displacements = {Vec3(-0.5, 0.25, 4)};
    phantom.truth.walls = {{"bladder", 4, 2, 0.5, Vec3(1, 2, 3), Vec3(100, -200, 300)}};
    phantom.truth.peak_displacement_mm = 8.5;
    return phantom;
}

class PelvisFiles : public testing::Test {
protected:
    void SetUp() override {
        folder = fs::temp_directory_path() / ("palpate_pelvis_files_" + std::to_string(::getpid()));
        fs::remove_all(folder);
        options.seed = 7;
        options.stiffness_kpa = 123;
    }
    void TearDown() override { fs::remove_all(folder); }
    fs::path folder;
    PelvisOptions options;
};

TEST_F(PelvisFiles, HoldVolumesSettingsLandmarksAndTruth) {
    const PelvisPhantom phantom = tiny_phantom();

    write_pelvis(phantom, options, folder / "a");

    const LabelImage target = read_label_image(folder / "a" / "target.nii.gz");
    EXPECT_EQ(target.voxels, phantom.target.voxels);
    EXPECT_LT((target.grid.origin - phantom.target.grid.origin).norm(), 1e-5);
    EXPECT_EQ(read_label_image(folder / "a" / "reference.nii.gz").voxels, phantom.reference.voxels);
    const Settings settings = read_settings(folder / "a" / "organs.toml");
    EXPECT_EQ(settings.organs.at(1).name, "bladder");
    EXPECT_FALSE(settings.organs.at(0).stiffness_kpa.has_value());
    EXPECT_EQ(text_of(folder / "a" / "landmarks.csv"),
              "x_mm,y_mm,z_mm,dx_mm,dy_mm,dz_mm\n"
              "1.000000,2.000000,3.000000,-0.500000,0.250000,4.000000\n");
    const auto truth = nlohmann::json::parse(text_of(folder / "a" / "truth.json"));
    EXPECT_EQ(truth["seed"], 7);
    EXPECT_EQ(truth["regions"][1]["stiffness_kpa"], 123);
    EXPECT_EQ(truth["load"]["walls"][0]["resultant_force_mn"][1], -200);
    EXPECT_EQ(truth["peak_displacement_mm"], 8.5);
}

TEST_F(PelvisFiles, NameTheStiffnessOfBothZones) {
    PelvisPhantom phantom = tiny_phantom();
    phantom.settings.organs[0].name = "peripheral_zone";
    phantom.settings.organs.push_back({"transition_zone", 6, Role::tissue, false, {}, 0.40});
    options.zone_stiffness_kpa = {210.0, 55.0};

    write_pelvis(phantom, options, folder / "a");

    const auto truth = nlohmann::json::parse(text_of(folder / "a" / "truth.json"));
    EXPECT_EQ(truth["regions"][1]["stiffness_kpa"], 55);
    EXPECT_EQ(truth["regions"][3]["stiffness_kpa"], 210);
}

TEST_F(PelvisFiles, HoldTheSurfacesOfTheTarget) {
    PelvisPhantom phantom = tiny_phantom();
    phantom.mesh.surface.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    phantom.mesh.surface.triangles = {{0, 1, 2}};
    phantom.mesh.surface.regions = {{first_organ_region, background_region}};
    phantom.mesh.surface.on_image_border = {0};
    phantom.displacement.assign(3, Vec3(0, 0, 2.5));

    write_pelvis(phantom, options, folder / "a");

    const std::string text = text_of(folder / "a" / "target_prostate.ply");
    EXPECT_NE(text.find("element vertex 3\n"), std::string::npos);
    EXPECT_NE(text.find("\n1.000000 0.000000 2.500000\n"), std::string::npos);
    EXPECT_NE(text.find("\n3 0 1 2\n"), std::string::npos);
    EXPECT_NE(text_of(folder / "a" / "target_bladder.ply").find("element face 0\n"),
              std::string::npos);
    EXPECT_FALSE(fs::exists(folder / "a" / "target_bone.ply"));
}

TEST_F(PelvisFiles, AreTheSameBytesForTheSamePhantom) {
    write_pelvis(tiny_phantom(), options, folder / "a");
    write_pelvis(tiny_phantom(), options, folder / "b");

    for (const char* name : {"reference.nii.gz", "target.nii.gz", "organs.toml", "truth.json",
                             "landmarks.csv", "target_prostate.ply", "target_bladder.ply"}) {
        const std::string text = text_of(folder / "a" / name);
        EXPECT_FALSE(text.empty()) << name;
        EXPECT_EQ(text, text_of(folder / "b" / name)) << name;
    }
}

TEST_F(PelvisFiles, NeverReplaceAFolderAndLeaveNothingBehind) {
    write_pelvis(tiny_phantom(), options, folder / "a");
    const std::string before = text_of(folder / "a" / "truth.json");
    options.seed = 8;

    try {
        write_pelvis(tiny_phantom(), options, folder / "a");
        FAIL() << "an existing folder was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::output_failed);
    }

    EXPECT_EQ(text_of(folder / "a" / "truth.json"), before);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST_F(PelvisFiles, OfSeveralLoadsAreATableWithAFolderForEach) {
    const auto two = [](const PelvisSink& take) {
        PelvisPhantom phantom = tiny_phantom();
        take(phantom);
        phantom.truth.load = 2;
        phantom.truth.load_family = LoadFamily::bump;
        phantom.target.at(1, 1, 1) = 1;
        take(phantom);
    };

    write_pelvis_loads(options, two, folder / "a");

    EXPECT_EQ(text_of(folder / "a" / "pairs.tsv"),
              "participant_id\treference\ttarget\n"
              "phantom-7\treference.nii.gz\ttarget-01/target.nii.gz\n"
              "phantom-7\treference.nii.gz\ttarget-02/target.nii.gz\n");
    EXPECT_EQ(read_label_image(folder / "a" / "target-02" / "target.nii.gz").at(1, 1, 1), 1);
    EXPECT_EQ(read_settings(folder / "a" / "organs.toml").organs.at(0).name, "prostate");
    const auto truth = nlohmann::json::parse(text_of(folder / "a" / "target-02" / "truth.json"));
    EXPECT_EQ(truth["load"]["number"], 2);
    EXPECT_EQ(truth["load_family"], "bump");
}

TEST_F(PelvisFiles, OfSeveralLoadsAreWholeOrNotThere) {
    const auto broken = [](const PelvisSink& take) {
        take(tiny_phantom());
        throw Error(ErrorCode::solve_failed, "no equilibrium");
    };
    fs::create_directories(folder);
    EXPECT_THROW(write_pelvis_loads(options, broken, folder / "a"), Error);
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(PelvisFiles, SayWhenTheParentIsAFile) {
    fs::create_directories(folder);
    std::ofstream(folder / "file") << "x";

    EXPECT_THROW(write_pelvis(tiny_phantom(), options, folder / "file" / "a"), Error);
}

}  // namespace
}  // namespace palpate
