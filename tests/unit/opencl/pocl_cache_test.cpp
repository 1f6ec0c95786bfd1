// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdio.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <string>

namespace palpate {
namespace {

namespace fs = std::filesystem;

class PoclCacheTest : public testing::Test {
protected:
    void SetUp() override {
        temp = fs::temp_directory_path() / fmt::format("palpate-test-{}", getpid());
        fs::create_directories(temp);
    }
    void TearDown() override { fs::remove_all(temp); }

    /// What a process that uses OpenCL has as its PoCL folder.
    std::string folder_of_process(const std::string& environment) const {
        const std::string command =
            fmt::format("env {} TMPDIR={} {}", environment, temp.string(), POCL_FOLDER_PROGRAM);
        FILE* output = popen(command.c_str(), "r");
        std::array<char, 4096> line = {};
        const bool has_line = fgets(line.data(), line.size(), output) != nullptr;
        EXPECT_EQ(pclose(output), 0) << command;
        std::string folder = has_line ? line.data() : "";
        if (!folder.empty() && folder.back() == '\n') folder.pop_back();
        return folder;
    }

    fs::path temp;
};

TEST_F(PoclCacheTest, IsPrivateToTheProcessAndGoneAtExit) {
    fs::create_directories(temp / "palpate-pocl-999999999-left" / "deep");

    const std::string first = folder_of_process("-u POCL_CACHE_DIR");
    const std::string second = folder_of_process("-u POCL_CACHE_DIR");

    EXPECT_EQ(first.rfind((temp / "palpate-pocl-").string(), 0), 0u) << first;
    EXPECT_EQ(second.rfind((temp / "palpate-pocl-").string(), 0), 0u) << second;
    EXPECT_NE(first, second);
    EXPECT_TRUE(fs::is_empty(temp)) << "a folder of this or of a dead process was left";
}

TEST_F(PoclCacheTest, ChoiceOfTheUserIsKept) {
    const fs::path own = temp / "own";
    fs::create_directories(own);

    EXPECT_EQ(folder_of_process("POCL_CACHE_DIR=" + own.string()), own.string());

    EXPECT_TRUE(fs::exists(own));
}

}  // namespace
}  // namespace palpate
