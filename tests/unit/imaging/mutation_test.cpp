// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>

#include "host/imaging/files.hpp"
#include "host/imaging/io.hpp"
#include "solver/base/error.hpp"

// Damaged volumes of each format, read as users' files are. What the checks let through meets the
// decoder in a child, which may die; this process may not.
//   PALPATE_MUTATIONS=10000 build/release/bin/mutation_test     the long form
namespace palpate {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr double longest_read_s = 5;  // processor time of a child is limited to 60 s
constexpr long largest_child_kib = 2L << 20;

int num_mutations() {
    const char* wanted = std::getenv("PALPATE_MUTATIONS");
    return wanted ? std::atoi(wanted) : 1000;
}

Bytes bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

LabelImage small_scene() {
    LabelImage image;
    image.grid.size = {9, 8, 7};
    image.grid.origin = Vec3(1, 2, 3);
    image.grid.spacing = Vec3(0.5, 1, 2);
    image.voxels.assign(image.grid.num_voxels(), 0);
    for (std::size_t v = 100; v < 300; ++v) image.voxels[v] = 300;
    return image;
}

class Mutator {
public:
    explicit Mutator(std::uint32_t seed) : random_(seed) {}

    /// One to four changes: bytes flipped or set to extremes, digits changed, parts removed,
    /// doubled or cut off. The first 512 bytes hold the header and are hit most.
    Bytes operator()(Bytes bytes) {
        for (std::size_t k = 1 + below(4); k > 0; --k) change(bytes);
        return bytes;
    }

private:
    std::size_t below(std::size_t count) { return count == 0 ? 0 : random_() % count; }

    void change(Bytes& bytes) {
        if (bytes.empty()) return;
        const std::size_t reach =
            below(4) == 0 ? bytes.size() : std::min<std::size_t>(512, bytes.size());
        const std::size_t at = below(reach);
        const std::size_t length = std::min(1 + below(16), bytes.size() - at);
        const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        const auto end = begin + static_cast<std::ptrdiff_t>(length);
        constexpr std::uint8_t extremes[] = {0x00, 0xff, 0x7f, 0x80, '-', '9', '\n', ' '};
        switch (below(7)) {
            case 0:
                *begin ^= static_cast<std::uint8_t>(1u << below(8));
                break;
            case 1:
                *begin = static_cast<std::uint8_t>(below(256));
                break;
            case 2:
                std::fill(begin, end, extremes[below(std::size(extremes))]);
                break;
            case 3:
                *begin = static_cast<std::uint8_t>('0' + below(10));
                break;
            case 4:
                bytes.erase(begin, end);
                break;
            case 5: {
                const Bytes part(begin, end);
                bytes.insert(begin, part.begin(), part.end());
                break;
            }
            default:
                if (below(4) == 0) bytes.resize(at);
        }
    }

    std::minstd_rand random_;
};

struct Counts {
    int accepted = 0, refused = 0, child_died = 0;
    double slowest_s = 0;
};

bool is_of_a_dead_child(const std::string& message) {
    for (const char* word : {"crashed", "too long", "more memory", "without a result"})
        if (message.find(word) != std::string::npos) return true;
    return false;
}

void read_one(const std::filesystem::path& path, Counts& counts) {
    const auto begin = std::chrono::steady_clock::now();
    try {
        const LabelImage image = read_label_image(path);
        ++counts.accepted;
        EXPECT_EQ(image.voxels.size(), image.grid.num_voxels());
    } catch (const Error& error) {
        const bool died = is_of_a_dead_child(error.what());
        ++(died ? counts.child_died : counts.refused);
        EXPECT_TRUE(error.code() == ErrorCode::input_unreadable ||
                    (!died && error.code() == ErrorCode::input_unusable))
            << error.what();
    }
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    counts.slowest_s = std::max(counts.slowest_s, spent.count());
}

class Mutation : public testing::TestWithParam<const char*> {};

TEST_P(Mutation, OfAVolumeIsReadOrRefused) {
    const PrivateFolder folder;
    const std::filesystem::path path = folder.path() / std::string("a").append(GetParam());
    write_label_image(path, small_scene());
    const Bytes good = bytes_of(path);
    Mutator mutate(7);
    Counts counts;

    for (int k = 0; k < num_mutations(); ++k) {
        const Bytes bytes = mutate(good);
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        read_one(path, counts);
    }

    rusage children{};
    getrusage(RUSAGE_CHILDREN, &children);
    std::cout << GetParam() << ": " << counts.accepted << " read, " << counts.refused
              << " refused, " << counts.child_died << " killed their child; slowest "
              << counts.slowest_s << " s, largest child " << children.ru_maxrss / 1024 << " MiB\n";
    EXPECT_GT(counts.accepted, 0);
    EXPECT_GT(counts.refused, 0);
    EXPECT_LT(counts.slowest_s, 4 * longest_read_s);  // the aim is 5 s; machines may be busy
    EXPECT_LT(children.ru_maxrss, largest_child_kib);
}

INSTANTIATE_TEST_SUITE_P(Format, Mutation, testing::Values(".nii", ".nrrd", ".mha", ".nii.gz"));

}  // namespace
}  // namespace palpate
