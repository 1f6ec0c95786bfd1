// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <limits>

#include "host/io/volume_files.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/imaging/nifti_bytes.hpp"

namespace palpate {
namespace {

using namespace testing;

constexpr ErrorCode unreadable = ErrorCode::input_unreadable;
constexpr ErrorCode unusable = ErrorCode::input_unusable;

/// The error of reading, checked to name the file.
void expect_refused(const std::filesystem::path& path, ErrorCode code, const std::string& word) {
    try {
        read_label_image(path);
        ADD_FAILURE() << path.filename() << " was accepted";
    } catch (const Error& error) {
        EXPECT_EQ(int(error.code()), int(code)) << error.what();
        EXPECT_NE(std::string(error.what()).find(path.filename().string()), std::string::npos);
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
}

struct Damage {
    const char* name;
    ErrorCode code;
    const char* word;  ///< in the message
    std::function<void(Bytes&)> apply;
};

std::ostream& operator<<(std::ostream& out, const Damage& damage) { return out << damage.name; }

const float nan_value = std::numeric_limits<float>::quiet_NaN();

class DamagedNifti : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedNifti, IsRefusedPlainAndCompressed) {
    const ScratchFolder folder;
    Bytes bytes = good_nifti();
    GetParam().apply(bytes);
    save(folder / "plain.nii", bytes);
    save(folder / "compressed.nii.gz", gzipped(bytes));

    expect_refused(folder / "plain.nii", GetParam().code, GetParam().word);
    expect_refused(folder / "compressed.nii.gz", GetParam().code, GetParam().word);
}

INSTANTIATE_TEST_SUITE_P(
    Corpus, DamagedNifti,
    ::testing::Values(
        Damage{"cut in half", unreadable, "cut off", [](Bytes& b) { b.resize(364); }},
        Damage{"header only", unreadable, "cut off", [](Bytes& b) { b.resize(352); }},
        Damage{"half a header", unreadable, "shorter", [](Bytes& b) { b.resize(100); }},
        Damage{"text", unreadable, "not a NIfTI",
               [](Bytes& b) { b.assign(400, std::uint8_t('x')); }},
        Damage{"NaN in the sform", unreadable, "sform",
               [](Bytes& b) { put(b, 284, nan_value); }},
        Damage{"infinite voxel size", unreadable, "voxel size",
               [](Bytes& b) { put(b, 80, std::numeric_limits<float>::infinity()); }},
        Damage{"negative extent", unreadable, "extent",
               [](Bytes& b) { put<std::int16_t>(b, 42, -4); }},
        Damage{"extent beyond the data", unreadable, "cut off",
               [](Bytes& b) { put<std::int16_t>(b, 46, 2000); }},
        Damage{"number of dimensions", unreadable, "dimensions",
               [](Bytes& b) { put<std::int16_t>(b, 40, 77); }},
        Damage{"four dimensions", unusable, "dimensions",
               [](Bytes& b) {
                   put<std::int16_t>(b, 40, 4);
                   put<std::int16_t>(b, 48, 5);
                   b.resize(352 + 24 * 5);
               }},
        Damage{"two dimensions", unusable, "dimensions",
               [](Bytes& b) { put<std::int16_t>(b, 40, 2); }},
        Damage{"one slice", unusable, "slice", [](Bytes& b) { put<std::int16_t>(b, 46, 1); }},
        Damage{"metres", unusable, "metres", [](Bytes& b) { b[123] = 1; }},
        Damage{"micrometres", unusable, "micrometres", [](Bytes& b) { b[123] = 3; }},
        Damage{"vector intent", unusable, "vectors",
               [](Bytes& b) { put<std::int16_t>(b, 68, 1007); }},
        Damage{"displacement intent", unusable, "vectors",
               [](Bytes& b) { put<std::int16_t>(b, 68, 1006); }},
        Damage{"colour voxels", unusable, "type", [](Bytes& b) { put<std::int16_t>(b, 70, 128); }},
        Damage{"bits per voxel", unreadable, "bits", [](Bytes& b) { put<std::int16_t>(b, 72, 64); }},
        Damage{"data offset", unreadable, "offset", [](Bytes& b) { put(b, 108, nan_value); }},
        Damage{"negative data offset", unreadable, "offset", [](Bytes& b) { put(b, 108, -8.f); }},
        Damage{"no orientation", unusable, "sform",
               [](Bytes& b) {
                   put<std::int16_t>(b, 252, 0);
                   put<std::int16_t>(b, 254, 0);
               }},
        Damage{"sheared sform", unusable, "right angles", [](Bytes& b) { put(b, 284, 1.5f); }},
        Damage{"sform of rank two", unusable, "grid", [](Bytes& b) { put(b, 280, 0.0f); }},
        Damage{"quaternion longer than one", unreadable, "orientation",
               [](Bytes& b) {
                   put<std::int16_t>(b, 254, 0);
                   put(b, 256, 3.0f);
               }},
        Damage{"separate image file", unreadable, ".img",
               [](Bytes& b) { std::memcpy(&b[344], "ni1", 4); }},
        Damage{"NIfTI-2", unreadable, "NIfTI-2",
               [](Bytes& b) { put<std::int32_t>(b, 0, 540); }},
        Damage{"negative label", unusable, "value",
               [](Bytes& b) {
                   put<std::int16_t>(b, 70, 256);
                   b[360] = 0xff;
               }},
        Damage{"fractional label", unusable, "value", [](Bytes& b) { put(b, 112, 0.5f); }},
        Damage{"NaN voxel", unusable, "finite",
               [](Bytes& b) {
                   put<std::int16_t>(b, 70, 16);
                   put<std::int16_t>(b, 72, 32);
                   b.resize(352 + 96);
                   for (int n = 0; n < 24; ++n) put(b, 352 + 4 * n, n == 9 ? nan_value : 1.f);
               }}));

TEST(Preflight, RefusesDamagedGzipStreams) {
    const ScratchFolder folder;
    const Bytes good = gzipped(good_nifti());
    save(folder / "good.nii.gz", good);
    EXPECT_NO_THROW(read_label_image(folder / "good.nii.gz"));

    save(folder / "cut.nii.gz", Bytes(good.begin(), good.begin() + good.size() / 2));
    save(folder / "tail.nii.gz", Bytes(good.begin(), good.end() - 4));
    Bytes bad_crc = good, bad_size = good, flipped = good, followed = good;
    bad_crc[good.size() - 8] ^= 1;
    bad_size[good.size() - 4] ^= 1;
    flipped[good.size() / 2] ^= 0x10;
    followed.push_back('x');
    save(folder / "crc.nii.gz", bad_crc);
    save(folder / "isize.nii.gz", bad_size);
    save(folder / "flipped.nii.gz", flipped);
    save(folder / "followed.nii.gz", followed);

    expect_refused(folder / "cut.nii.gz", unreadable, "");
    expect_refused(folder / "tail.nii.gz", unreadable, "cut off");
    expect_refused(folder / "crc.nii.gz", unreadable, "checksum");
    expect_refused(folder / "isize.nii.gz", unreadable, "checksum");
    expect_refused(folder / "flipped.nii.gz", unreadable, "");
    expect_refused(folder / "followed.nii.gz", unreadable, "followed");
}

TEST(Preflight, RefusesMissingAndForeignFiles) {
    const ScratchFolder folder;
    save(folder / "empty.nii", std::string());
    save(folder / "text.nrrd", std::string("hello"));
    save(folder / "text.mha", std::string("hello"));
    save(folder / "a.png", std::string("hello"));
    std::filesystem::create_directory(folder / "folder.nii");

    expect_refused(folder / "missing.nii.gz", unreadable, "no such file");
    expect_refused(folder / "empty.nii", unreadable, "empty");
    expect_refused(folder / "text.nrrd", unreadable, "not an NRRD");
    expect_refused(folder / "text.mha", unreadable, "MetaImage");
    expect_refused(folder / "a.png", unreadable, "format");
    expect_refused(folder / "folder.nii", unreadable, "not a file");
}

TEST(Preflight, RefusesAGzipBombQuickly) {
    const ScratchFolder folder;
    Bytes bytes = good_nifti();
    bytes.resize(bytes.size() + (std::size_t(64) << 20), 0);
    save(folder / "bomb.nii.gz", gzipped(bytes));
    Bytes claim = good_nifti();
    for (int n = 1; n <= 3; ++n) put<std::int16_t>(claim, 40 + 2 * n, 1000);
    save(folder / "claim.nii.gz", gzipped(claim));
    const auto start = std::chrono::steady_clock::now();

    expect_refused(folder / "bomb.nii.gz", unreadable, "more data");
    expect_refused(folder / "claim.nii.gz", unreadable, "cut off");

    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3));
}

/// A sound header of each text format with one line exchanged for another.
std::string nrrd_with(const std::string& line, const std::string& other) {
    std::string text =
        "NRRD0004\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 2\n"
        "space directions: (2,0,0) (0,3,0) (0,0,4)\nkinds: domain domain domain\n"
        "encoding: raw\nspace origin: (1,2,3)\n\n";
    const std::size_t at = text.find(line);
    if (at != std::string::npos) text.replace(at, line.size(), other);
    return text + std::string(24, '\1');
}
std::string meta_with(const std::string& line, const std::string& other) {
    std::string text =
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nCompressedData = False\n"
        "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 2 3 4\n"
        "DimSize = 4 3 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
    const std::size_t at = text.find(line);
    if (at != std::string::npos) text.replace(at, line.size(), other);
    return text + std::string(24, '\1');
}

TEST(Preflight, RefusesDamagedNrrd) {
    const ScratchFolder folder;
    auto refuse = [&](const char* line, const char* other, ErrorCode code, const char* word) {
        SCOPED_TRACE(other);
        save(folder / "a.nrrd", nrrd_with(line, other));
        expect_refused(folder / "a.nrrd", code, word);
    };
    save(folder / "good.nrrd", nrrd_with("", ""));
    EXPECT_NO_THROW(read_label_image(folder / "good.nrrd"));

    refuse("sizes: 4 3 2", "sizes: 4 3 9", unreadable, "cut off");
    refuse("sizes: 4 3 2", "sizes: 4 3 x", unreadable, "number");
    refuse("sizes: 4 3 2", "sizes: 4 6", unreadable, "contradicts");
    refuse("dimension: 3", "dimension: 4", unreadable, "contradicts");
    refuse("dimension: 3\n", "", unreadable, "dimension");
    refuse("(2,0,0)", "(nan,0,0)", unreadable, "number");
    refuse("(2,0,0)", "(2,0)", unreadable, "space directions");
    refuse("(2,0,0)", "(2,1,0)", unusable, "right angles");
    refuse("domain domain domain", "vector domain domain", unusable, "vector");
    refuse("space origin", "space units: \"m\" \"m\" \"m\"\nspace origin", unusable, "only mm");
    refuse("encoding: raw", "encoding: hex", unreadable, "encoding");
    refuse("encoding: raw", "encoding: gzip", unreadable, "");
    refuse("type: uchar", "type: block", unusable, "type");
    refuse("encoding: raw", "byte skip: -1\nencoding: raw", unreadable, "byte skip");
    refuse("sizes: 4 3 2", "sizes: 2000000 2000000 2", unusable, "voxels");
}

TEST(Preflight, RefusesDamagedMetaImage) {
    const ScratchFolder folder;
    auto refuse = [&](const char* line, const char* other, ErrorCode code, const char* word) {
        SCOPED_TRACE(other);
        save(folder / "a.mha", meta_with(line, other));
        expect_refused(folder / "a.mha", code, word);
    };
    save(folder / "good.mha", meta_with("", ""));
    EXPECT_NO_THROW(read_label_image(folder / "good.mha"));

    refuse("DimSize = 4 3 2", "DimSize = 4 3 9", unreadable, "cut off");
    refuse("DimSize = 4 3 2", "DimSize = 4 3 2 1", unreadable, "contradicts");
    refuse("NDims = 3", "NDims = 300000000", unreadable, "contradicts");
    refuse("ElementSpacing = 2 3 4", "ElementSpacing = 2 inf 4", unreadable, "number");
    refuse("ElementSpacing = 2 3 4", "ElementSpacing = 2 0 4", unusable, "");
    refuse("Offset = 1 2 3", "Offset = 1 2", unreadable, "Offset");
    refuse("1 0 0 0 1 0 0 0 1", "1 1 0 0 1 0 0 0 1", unusable, "right angles");
    refuse("CompressedData = False", "CompressedData = True", unreadable, "compressed");
    refuse("BinaryData = True", "BinaryData = False", unreadable, "binary");
    refuse("MET_UCHAR", "MET_STRING", unusable, "type");
    refuse("NDims = 3", "NDims = 3\nElementNumberOfChannels = 3", unusable, "several");
    refuse("NDims = 3", "NDims = 3\nHeaderSize = -1", unreadable, "HeaderSize");
    refuse("NDims = 3", "NDims = 3\nNDims = 3", unreadable, "twice");
    refuse("= LOCAL", "= other.raw", unreadable, ".mhd");
}

TEST(Preflight, RefusesDetachedDataOutsideTheFolder) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "in");
    save(folder / "out.raw", Bytes(24, 1));
    std::filesystem::create_symlink(folder / "out.raw", folder / "in/link.raw");
    const std::string absolute = (folder / "out.raw").string();

    for (const std::string& name : {std::string("../out.raw"), absolute,
                                    std::string("./../in/../out.raw"), std::string("link.raw")}) {
        SCOPED_TRACE(name);
        save(folder / "in/a.nhdr",
             "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\n"
             "encoding: raw\ndata file: " +
                 name + "\n");
        save(folder / "in/a.mhd",
             "NDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\n"
             "ElementDataFile = " +
                 name + "\n");

        expect_refused(folder / "in/a.nhdr", unreadable, "outside");
        expect_refused(folder / "in/a.mhd", unreadable, "outside");
    }
    save(folder / "in/a.mhd", std::string("NDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\n"
                                          "ElementDataFile = missing.raw\n"));
    expect_refused(folder / "in/a.mhd", unreadable, "no such file");
    save(folder / "in/a.mhd", std::string("NDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\n"
                                          "ElementDataFile = LIST\nx.raw\n"));
    expect_refused(folder / "in/a.mhd", unreadable, "several files");
}

TEST(Preflight, SurvivesRandomDamageOfEveryFormat) {
    // Accepted or refused with an Error, but never anything else.
    const ScratchFolder folder;
    const std::string nrrd = nrrd_with("", ""), meta = meta_with("", "");
    const std::vector<std::pair<std::string, Bytes>> files{
        {"a.nii", good_nifti()},
        {"a.nii.gz", gzipped(good_nifti())},
        {"a.nrrd", Bytes(nrrd.begin(), nrrd.end())},
        {"a.mha", Bytes(meta.begin(), meta.end())}};
    std::uint32_t state = 12345;
    auto random = [&](std::size_t below) {
        state = state * 1664525u + 1013904223u;
        return std::size_t(state >> 8) % below;
    };
    for (const auto& [name, good] : files) {
        for (int n = 0; n < 60; ++n) {
            Bytes bytes = good;
            for (std::size_t flips = 1 + random(4); flips > 0; --flips) {
                bytes[random(std::min<std::size_t>(bytes.size(), 352))] = std::uint8_t(random(256));
            }
            save(folder / name, bytes);
            try {
                read_label_image(folder / name);
            } catch (const Error& error) {
                EXPECT_TRUE(error.code() == unreadable || error.code() == unusable) << error.what();
            }
        }
    }
}

}  // namespace
}  // namespace palpate
