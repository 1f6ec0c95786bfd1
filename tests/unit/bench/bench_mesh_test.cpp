// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/bench_mesh.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/fixtures/columns.hpp"

namespace palpate::bench {
namespace {

class BenchMeshFile : public testing::Test {
protected:
    void SetUp() override {
        std::filesystem::create_directories(folder_);
        write_bench_mesh(path_, bench_mesh("", "box"));
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void overwrite(std::streamoff at, char byte) {
        std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(at);
        file.put(byte);
    }

    std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) /
                                    (std::string("bench_mesh_") +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::path path_ = folder_ / "small.mesh";
};

TEST_F(BenchMeshFile, ComesBackAsItWasWritten) {
    const BenchMesh& written = bench_mesh("", "box");

    const BenchMesh read = read_bench_mesh(path_);

    EXPECT_EQ(read.name, "small");
    EXPECT_EQ(read.model.mesh.nodes, written.model.mesh.nodes);
    EXPECT_EQ(read.model.mesh.tets, written.model.mesh.tets);
    EXPECT_EQ(read.model.mesh.region, written.model.mesh.region);
    EXPECT_EQ(read.model.prescribed, written.model.prescribed);
    EXPECT_EQ(read.prescribed_mm, written.prescribed_mm);
    ASSERT_EQ(read.model.materials.size(), written.model.materials.size());
    EXPECT_EQ(read.model.materials[1].stiffness_kpa, written.model.materials[1].stiffness_kpa);
    EXPECT_EQ(read.model.materials[1].poisson_ratio, written.model.materials[1].poisson_ratio);
}

TEST_F(BenchMeshFile, IsRefusedWhereDamaged) {
    const auto refused = [&] { return fixtures::code_of([&] { read_bench_mesh(path_); }); };
    const auto bytes = std::filesystem::file_size(path_);

    std::filesystem::resize_file(path_, bytes + 1);
    EXPECT_EQ(refused(), ErrorCode::input_unreadable) << "too long";
    std::filesystem::resize_file(path_, bytes - 1);
    EXPECT_EQ(refused(), ErrorCode::input_unreadable) << "cut off";
    std::filesystem::resize_file(path_, 10);
    EXPECT_EQ(refused(), ErrorCode::input_unreadable) << "shorter than the header";
    std::filesystem::remove(path_);
    EXPECT_EQ(refused(), ErrorCode::input_unreadable) << "missing";
}

TEST_F(BenchMeshFile, IsRefusedWhereOfAnotherKindOrVersionOrWithAbsurdCounts) {
    for (const std::streamoff at : {0, 8, 15, 19, 23}) {  // magic, version, counts
        write_bench_mesh(path_, bench_mesh("", "box"));
        overwrite(at, '\x7f');
        EXPECT_EQ(fixtures::code_of([&] { read_bench_mesh(path_); }), ErrorCode::input_unreadable)
            << "byte " << at;
    }
}

TEST_F(BenchMeshFile, IsRefusedWhereATetNamesNoNode) {
    const Model& model = bench_mesh("", "box").model;
    const std::streamoff tets = 24 + 48 * std::streamoff(model.mesh.num_nodes()) +
                                16 * std::streamoff(model.materials.size());
    overwrite(tets + 3, '\x7f');

    EXPECT_EQ(fixtures::code_of([&] { read_bench_mesh(path_); }), ErrorCode::invalid_argument);
}

TEST(MeshFolder, IsTakenOutOfTheArguments) {
    std::string program = "bench", option = "--meshes=/some/where", other = "--benchmark_x";
    char* arguments[] = {program.data(), option.data(), other.data()};
    int count = 3;

    EXPECT_EQ(take_mesh_folder(count, arguments), "/some/where");
    ASSERT_EQ(count, 2);
    EXPECT_STREQ(arguments[1], "--benchmark_x");
}

}  // namespace
}  // namespace palpate::bench
