// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace palpate {
namespace {

namespace fs = std::filesystem;

class PoclEnvironmentTest : public testing::Test {
protected:
    void SetUp() override {
        temp = fs::temp_directory_path() / fmt::format("palpate-test-{}", getpid());
        fs::create_directories(temp);
    }
    void TearDown() override { fs::remove_all(temp); }

    struct Seen {
        std::string folder;          ///< POCL_CACHE_DIR
        std::string specialization;  ///< POCL_WORK_GROUP_SPECIALIZATION
    };
    /// What a process that uses OpenCL has in its environment.
    Seen seen_with(const std::string& environment) const {
        const fs::path answer = temp / "answer";
        const std::string command = fmt::format(
            "env -u POCL_CACHE_DIR -u POCL_WORK_GROUP_SPECIALIZATION TMPDIR={} {} {} > {}",
            temp.string(), environment, POCL_ENVIRONMENT_PROGRAM, answer.string());
        EXPECT_EQ(std::system(command.c_str()), 0) << command;
        Seen seen;
        std::ifstream file(answer);
        std::getline(file, seen.folder);
        std::getline(file, seen.specialization);
        fs::remove(answer);
        return seen;
    }

    fs::path temp;
};

TEST_F(PoclEnvironmentTest, CacheIsPrivateToTheProcessAndGoneAtExit) {
    fs::create_directories(temp / "palpate-pocl-cache-host-1-left" / "deep");

    const std::string first = seen_with("").folder;
    const std::string second = seen_with("").folder;

    EXPECT_EQ(fs::path(first).filename().string().rfind("palpate-pocl-", 0), 0u) << first;
    EXPECT_NE(first, second);
    EXPECT_FALSE(fs::exists(first) || fs::exists(second));
    EXPECT_TRUE(fs::is_empty(temp)) << "a folder of this or of a dead process was left";
}

/// As processes of another machine or container look here.
TEST_F(PoclEnvironmentTest, FolderInUseIsKeptThoughNoProcessOfThatNumberIsHere) {
    const fs::path left = temp / "palpate-pocl-999999999-left";
    const fs::path of_another = temp / "palpate-pocl-cache-host-999999999-used";
    for (const fs::path& folder : {left, of_another}) fs::create_directories(folder);
    const int lock = open(of_another.c_str(), O_RDONLY | O_DIRECTORY);
    ASSERT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0);

    seen_with("");

    EXPECT_TRUE(fs::exists(of_another));
    EXPECT_TRUE(fs::exists(left)) << "of another version: it may be in use";
    close(lock);
}

TEST_F(PoclEnvironmentTest, CacheIsPrivateWithoutATemporaryFolderToo) {
    const std::string folder = seen_with("TMPDIR=" + (temp / "gone").string()).folder;

    EXPECT_EQ(fs::path(folder).filename().string().rfind("palpate-pocl-", 0), 0u) << folder;
}

TEST_F(PoclEnvironmentTest, KernelsAreNotCompiledAgainAtTheirFirstLaunch) {
    EXPECT_EQ(seen_with("").specialization, "0");
}

TEST_F(PoclEnvironmentTest, ChoicesOfTheUserAreKept) {
    const fs::path own = temp / "own";
    fs::create_directories(own);

    const Seen seen =
        seen_with("POCL_CACHE_DIR=" + own.string() + " POCL_WORK_GROUP_SPECIALIZATION=1");

    EXPECT_EQ(seen.folder, own.string());
    EXPECT_EQ(seen.specialization, "1");
    EXPECT_TRUE(fs::exists(own));
}

}  // namespace
}  // namespace palpate
