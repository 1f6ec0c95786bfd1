// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/program_cache.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "solver/backends/opencl/context.hpp"
#include "solver/backends/opencl/launch.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

const std::string twice_text =
    "kernel __attribute__((reqd_work_group_size(1, 64, 1))) void twice(global float* x) {\n"
    "    x[get_global_id(1)] *= FACTOR;\n"
    "}\n";

void do_nothing(int) {}

class ProgramCacheTest : public testing::Test {
protected:
    void SetUp() override {
        std::signal(SIGINT, do_nothing);  // before a driver begins
        try {
            device = open_device("");
        } catch (const Error& error) {
            GTEST_SKIP() << error.what();
        }
        folder = fs::temp_directory_path() / fmt::format("palpate-cache-test-{}", getpid());
        fs::remove_all(folder);
    }
    void TearDown() override {
        std::signal(SIGINT, SIG_DFL);
        if (!folder.empty()) fs::remove_all(folder);
    }

    ProgramCache make_cache() const { return {device->context, device->device, folder}; }
    ProgramCache make_cache(const fs::path& other) const {
        return {device->context, device->device, other};
    }
    /// What the program makes of 1.
    float run(ProgramCache& cache, long factor = 2) const {
        cl::Kernel kernel(cache.get_text("twice", twice_text, {{"FACTOR", factor}}), "twice");
        cl::CommandQueue queue(device->context, device->device);
        std::vector<float> x(64, 1.0f);
        cl::Buffer buffer(device->context, CL_MEM_READ_WRITE, 256);
        queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, 256, x.data());
        launch(queue, kernel, WorkSize{1, 64, {1, 64}}, buffer);
        queue.enqueueReadBuffer(buffer, CL_TRUE, 0, 256, x.data());
        return x.back();
    }
    std::vector<fs::path> entries() const {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(folder)) found.push_back(entry.path());
        return found;
    }

    std::shared_ptr<OpenclDevice> device;
    fs::path folder;
};

void expect_counts(const ProgramCache& cache, int built, int loaded) {
    EXPECT_EQ(cache.counts().built, built);
    EXPECT_EQ(cache.counts().loaded, loaded);
}

TEST_F(ProgramCacheTest, CompilersLeaveTheSignalsToTheProgram) {
    for (int round = 0; round < 2; ++round) {  // built, then loaded
        ProgramCache cache = make_cache();
        run(cache);

        struct sigaction now {};
        sigaction(SIGINT, nullptr, &now);
        EXPECT_EQ(now.sa_handler, &do_nothing);
    }
}

TEST_F(ProgramCacheTest, ColdBuildsWarmLoadsAndBothCompute) {
    ProgramCache cold = make_cache();
    EXPECT_EQ(run(cold), 2.0f);
    EXPECT_EQ(run(cold), 2.0f);
    expect_counts(cold, 1, 0);
    ASSERT_EQ(entries().size(), 1u);

    ProgramCache warm = make_cache();
    EXPECT_EQ(run(warm), 2.0f);
    expect_counts(warm, 0, 1);
}

TEST_F(ProgramCacheTest, OtherDefinesAreAnotherProgram) {
    ProgramCache cache = make_cache();

    EXPECT_EQ(run(cache, 2), 2.0f);
    EXPECT_EQ(run(cache, 3), 3.0f);

    expect_counts(cache, 2, 0);
    EXPECT_EQ(entries().size(), 2u);
}

TEST_F(ProgramCacheTest, DamagedEntryIsRebuilt) {
    ProgramCache cold = make_cache();
    run(cold);
    const fs::path entry = entries().at(0);
    const auto size = fs::file_size(entry);
    const auto flip_byte = [&](std::uintmax_t at) {
        std::fstream file(entry, std::ios::binary | std::ios::in | std::ios::out);
        file.seekg(at);
        const char byte = static_cast<char>(file.get() ^ 0x10);
        file.seekp(at);
        file.put(byte);
    };
    const std::vector<std::function<void()>> damages = {
        [&] { fs::resize_file(entry, 0); },
        [&] { fs::resize_file(entry, size / 2); },
        [&] { flip_byte(3); },
        [&] { flip_byte(size / 2); },
        [&] { flip_byte(size - 1); },
        [&] { std::ofstream(entry, std::ios::app) << "more"; },
    };
    for (const auto& damage : damages) {
        damage();
        ProgramCache healed = make_cache();
        EXPECT_EQ(run(healed), 2.0f);
        expect_counts(healed, 1, 0);

        ProgramCache warm = make_cache();
        EXPECT_EQ(run(warm), 2.0f);
        expect_counts(warm, 0, 1);
    }
}

TEST_F(ProgramCacheTest, EntryThatTheDriverRefusesIsRebuilt) {
    ProgramCache cold = make_cache();
    const std::string key = cold.key_of(twice_text, {{"FACTOR", 2}});
    ProgramFolder(folder).write(key, ProgramBinary(100, 0x55));
    ASSERT_TRUE(ProgramFolder(folder).read(key).has_value());

    EXPECT_EQ(run(cold), 2.0f);

    expect_counts(cold, 1, 0);
    ProgramCache warm = make_cache();
    EXPECT_EQ(run(warm), 2.0f);
    expect_counts(warm, 0, 1);
}

TEST_F(ProgramCacheTest, FolderThatCannotBeWrittenIsNoCache) {
    std::ofstream(folder) << "a file where the folder should be";
    for (const fs::path& unusable : {folder / "below", fs::path("/proc/palpate"), fs::path()}) {
        ProgramCache first = make_cache(unusable);
        EXPECT_EQ(run(first), 2.0f);
        ProgramCache second = make_cache(unusable);
        EXPECT_EQ(run(second), 2.0f);
        expect_counts(second, 1, 0);
    }
}

TEST_F(ProgramCacheTest, BrokenSourceShowsTheBuildLog) {
    ProgramCache cache = make_cache();
    try {
        cache.get_text("broken", "kernel void broken() { nonsense here; }", {{"WIDTH", 4}});
        FAIL() << "nonsense compiled";
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(error.code(), ErrorCode::kernel_build_failed);
        for (const char* part : {"broken", "-DWIDTH=4", "nonsense"})
            EXPECT_NE(message.find(part), std::string::npos) << message;
    }
    EXPECT_FALSE(fs::exists(folder));
}

TEST_F(ProgramCacheTest, KeyNamesDeviceDriverOptionsAndSource) {
    const std::string key = make_cache().key_of("the source", {{"COLUMN_WIDTH", 4}});

    for (const std::string& part :
         {device->info.name, device->info.version, device->info.driver, device->info.platform,
          std::string("-DCOLUMN_WIDTH=4"), std::string("the source")})
        EXPECT_NE(key.find(part), std::string::npos) << part;
}

TEST(DefaultCacheFolder, FollowsTheEnvironment) {
    const auto with = [](const char* name, const char* value) {
        const char* old = std::getenv(name);
        const std::string saved = old ? old : "";
        setenv(name, value, 1);
        const fs::path folder = default_cache_folder();
        old ? setenv(name, saved.c_str(), 1) : unsetenv(name);
        return folder;
    };

    EXPECT_EQ(with("PALPATE_CACHE_DIR", "/somewhere/own"), "/somewhere/own");
    unsetenv("PALPATE_CACHE_DIR");
    EXPECT_EQ(with("XDG_CACHE_HOME", "/somewhere/xdg"), "/somewhere/xdg/palpate");
}

}  // namespace
}  // namespace palpate
