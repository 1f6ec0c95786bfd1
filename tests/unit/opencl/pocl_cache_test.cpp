// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/pocl_cache.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace palpate {
namespace {

namespace fs = std::filesystem;

// Runs in a forked child, because the folder belongs to a process: returns what the child wrote.
std::string in_child(const fs::path& temp, const char* user_choice) {
    const fs::path answer = temp / "answer";
    const pid_t child = fork();
    if (child == 0) {
        setenv("TMPDIR", temp.c_str(), 1);
        user_choice ? setenv("POCL_CACHE_DIR", user_choice, 1) : unsetenv("POCL_CACHE_DIR");
        use_private_pocl_cache();
        const std::string folder = getenv("POCL_CACHE_DIR");
        std::ofstream(answer) << folder << (fs::is_directory(folder) ? "" : " is missing");
        exit(0);  // runs the exit handlers
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
    std::string text;
    std::getline(std::ifstream(answer), text);
    fs::remove(answer);
    return text;
}

TEST(PoclCache, IsPrivateToTheProcessAndGoneAtExit) {
    const fs::path temp =
        fs::temp_directory_path() / ("palpate-pocl-test-" + std::to_string(getpid()));
    fs::create_directories(temp / "palpate-pocl-999999999-left" / "deep");

    const std::string first = in_child(temp, nullptr);
    const std::string second = in_child(temp, nullptr);

    EXPECT_EQ(first.rfind((temp / "palpate-pocl-").string(), 0), 0u) << first;
    EXPECT_EQ(first.find("missing"), std::string::npos) << first;
    EXPECT_NE(first, second);
    EXPECT_TRUE(fs::is_empty(temp)) << "folders of dead processes or of this one were left";
    fs::remove_all(temp);
}

TEST(PoclCache, ChoiceOfTheUserIsKept) {
    const fs::path temp =
        fs::temp_directory_path() / ("palpate-pocl-test-" + std::to_string(getpid()));
    fs::create_directories(temp);

    EXPECT_EQ(in_child(temp, temp.c_str()), temp.string());

    EXPECT_TRUE(fs::exists(temp));
    fs::remove_all(temp);
}

}  // namespace
}  // namespace palpate
