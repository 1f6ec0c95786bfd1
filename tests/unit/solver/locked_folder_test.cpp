// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/base/locked_folder.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class LockedFolderTest : public testing::Test {
protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "palpate-test-XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        parent = name;
    }
    void TearDown() override { fs::remove_all(parent); }
    std::unique_ptr<LockedFolder> one() const {
        return std::make_unique<LockedFolder>(parent, "work-", LockedFolder::Readers::owner);
    }
    fs::path parent;
};

TEST_F(LockedFolderTest, IsNotRemovedUnderAProcessThatHasJustMadeIt) {
    std::atomic<bool> is_over{false};
    const auto sweep = [&] {
        while (!is_over) remove_left_behind(parent, "work-");
    };
    std::vector<std::thread> others;
    for (int k = 0; k < 2; ++k) others.emplace_back(sweep);

    int num_lost = 0;
    for (int k = 0; k < 100; ++k) {
        const auto folder = one();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // others remove it meanwhile
        if (!std::ofstream(folder->path() / "file").put('x')) ++num_lost;
    }
    is_over = true;
    for (std::thread& other : others) other.join();

    EXPECT_EQ(num_lost, 0);
    EXPECT_TRUE(fs::is_empty(parent));
}

TEST_F(LockedFolderTest, IsLeftAloneByAForkedChild) {
    auto folder = one();

    const pid_t child = fork();
    if (child == 0) {
        folder.reset();
        _exit(0);
    }
    waitpid(child, nullptr, 0);

    EXPECT_TRUE(fs::exists(folder->path()));
}

TEST_F(LockedFolderTest, OfAKilledProcessIsRemovedByTheNextOneOnly) {
    const pid_t child = fork();
    if (child == 0) {
        static const auto left = one();
        std::ofstream(left->path() / "file") << "x";
        _exit(0);
    }
    waitpid(child, nullptr, 0);
    ASSERT_FALSE(fs::is_empty(parent));
    const LockedFolder of_another_kind(parent, "other-", LockedFolder::Readers::owner);

    const auto next = one();

    const std::ptrdiff_t num_left =
        std::distance(fs::directory_iterator(parent), fs::directory_iterator());
    EXPECT_EQ(num_left, 2);
}

TEST_F(LockedFolderTest, ThatIsRemovedAtTheEndOfAProgramCannotBeRenamedAnyMore) {
    const auto folder = one();
    std::ofstream(folder->path() / "half") << "x";
    const auto kept = one();
    fs::rename(kept->path(), parent / "result");
    kept->keep();

    remove_folders_in_progress();

    std::error_code failed;
    fs::rename(folder->path(), parent / "half", failed);
    EXPECT_TRUE(failed);
    EXPECT_TRUE(fs::exists(parent / "result"));
    EXPECT_EQ(std::distance(fs::directory_iterator(parent), fs::directory_iterator()), 1);
}

TEST_F(LockedFolderTest, SaysWhyNoneCanBeMade) {
    try {
        const LockedFolder folder(parent / "nowhere", "work-", LockedFolder::Readers::owner);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::output_failed);
        EXPECT_NE(std::string(error.what()).find("No such file"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate
