// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/files.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

void write_note(const fs::path& path) { std::ofstream(path) << "note"; }

std::ptrdiff_t num_entries(const fs::path& folder) {
    return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(WriteAtomically, RemovesWhatAKilledRunLeftOfThisFileOnly) {
    const PrivateFolder folder;
    const fs::path left = folder.path() / ".field.nii.unfinished-host-1-a";
    const fs::path of_other_file = folder.path() / ".mesh.vtu.unfinished-host-1-a";
    for (const fs::path& each : {left, of_other_file}) fs::create_directories(each / "deep");
    const LockedFolder in_use(folder.path(), ".field.nii.unfinished-",
                              LockedFolder::Readers::owner);

    write_atomically(folder.path() / "field.nii", write_note);

    EXPECT_FALSE(fs::exists(left));
    EXPECT_TRUE(fs::exists(of_other_file));
    EXPECT_TRUE(fs::exists(in_use.path()));
    EXPECT_EQ(fs::file_size(folder.path() / "field.nii"), 4u);
    EXPECT_EQ(num_entries(folder.path()), 3);
}

TEST(WriteAtomically, KeepsTheOldFileAndNothingElseWhenWritingFails) {
    const PrivateFolder folder;
    const fs::path file = folder.path() / "table.csv";
    write_atomically(file, write_note);

    EXPECT_THROW(write_atomically(file,
                                  [](const fs::path& temporary) {
                                      std::ofstream(temporary) << "half of it";
                                      throw std::runtime_error("broken");
                                  }),
                 Error);

    EXPECT_EQ(fs::file_size(file), 4u);
    EXPECT_EQ(num_entries(folder.path()), 1);
}

TEST(WriteAtomically, NamesTheFileThatCannotBeWritten) {
    const PrivateFolder folder;
    try {
        write_atomically(folder.path() / "nowhere" / "table.csv", write_note);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::output_failed);
        EXPECT_NE(std::string(error.what()).find("nowhere/table.csv"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate
