// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/nifti_file.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>

#include "host/io/displacement_steps.hpp"
#include "host/io/files.hpp"
#include "host/io/gzip.hpp"
#include "host/io/preflight.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little,
              "files are written as they lie in memory");

struct Format {
    std::int16_t code;
    std::int16_t bits;
    Index components;
};

// Displacements as integers with a scale would be smaller still: ITK 5.4 crashes on such vectors.
Format codes_of(NiftiNumbers numbers) {
    switch (numbers) {
        case NiftiNumbers::bytes:
            return {2, 8, 1};
        case NiftiNumbers::words:
            return {512, 16, 1};
        case NiftiNumbers::singles:
            return {16, 32, 1};
        case NiftiNumbers::displacements:
            return {16, 32, 3};
    }
    throw Error(ErrorCode::internal, "a kind of number that NIfTI does not have");
}

/// Fields go to their places in nifti1.h of the NIfTI committee.
class Header {
public:
    explicit Header(std::uint8_t* bytes) : bytes_(bytes) {}

    template <typename T>
    void put(std::size_t place, T value) {
        std::memcpy(bytes_ + place, &value, sizeof value);
    }
    void put_text(std::size_t place, const char* text) {
        std::memcpy(bytes_ + place, text, std::strlen(text));
    }

private:
    std::uint8_t* bytes_;
};

void put_size(Header& header, const ImageGrid& grid, Index components) {
    const bool is_vector = components > 1;
    const Index dim[8] = {
        is_vector ? 5 : 3, grid.size[0], grid.size[1], grid.size[2], 1, components, 1, 1};
    for (std::size_t n = 0; n < 8; ++n) {
        if (dim[n] > std::numeric_limits<std::int16_t>::max())
            throw Error(ErrorCode::output_failed,
                        "NIfTI counts at most 32767 voxels along an axis, not " +
                            std::to_string(dim[n]) +
                            "; cut or resample the image, or write volumes as .nrrd or .mha and "
                            "displacements as .h5");
        header.put(40 + 2 * n, static_cast<std::int16_t>(dim[n]));
        header.put(76 + 4 * n, 1.0f);
    }
    for (int a = 0; a < 3; ++a) header.put(80 + 4 * a, static_cast<float>(grid.spacing[a]));
}

/// Where the voxels lie, in RAS mm: as a matrix (sform), and the same as quaternion (qform).
void put_place(Header& header, const ImageGrid& grid) {
    const Mat3 to_ras = Vec3(-1, -1, 1).asDiagonal();
    const Vec3 origin = to_ras * grid.origin;
    Mat3 axes = to_ras * grid.direction;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            header.put(280 + 16 * row + 4 * column,
                       static_cast<float>(axes(row, column) * grid.spacing[column]));
        header.put(292 + 16 * row, static_cast<float>(origin[row]));
        header.put(268 + 4 * row, static_cast<float>(origin[row]));
    }
    const bool is_mirrored = axes.determinant() < 0;
    if (is_mirrored) axes.col(2) *= -1;
    header.put(76, is_mirrored ? -1.0f : 1.0f);
    Eigen::Quaterniond q(axes);
    q.normalize();
    const double sign = q.w() < 0 ? -1 : 1;  // the format leaves w out: it is positive
    header.put(256, static_cast<float>(sign * q.x()));
    header.put(260, static_cast<float>(sign * q.y()));
    header.put(264, static_cast<float>(sign * q.z()));
    constexpr std::int16_t scanner = 1;
    header.put(252, scanner);
    header.put(254, scanner);
}

void write_bytes(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw Error(ErrorCode::output_failed, "it could not be written whole");
}

}  // namespace

NiftiFile::NiftiFile(const ImageGrid& grid, NiftiNumbers numbers) {
    const Format format = codes_of(numbers);
    size_ = numbers_offset + grid.num_voxels() * static_cast<std::size_t>(format.components) *
                                 static_cast<std::size_t>(format.bits / 8);
    bytes_ = std::make_unique_for_overwrite<std::uint8_t[]>(size_);
    std::fill_n(bytes_.get(), numbers_offset, std::uint8_t(0));
    Header header(bytes_.get());
    header.put(0, std::int32_t(348));
    put_size(header, grid, format.components);
    header.put(70, format.code);
    header.put(72, format.bits);
    header.put(108, static_cast<float>(numbers_offset));
    header.put(112, 1.0f);             // scale
    header.put(123, std::uint8_t(2));  // mm
    if (numbers == NiftiNumbers::displacements) {
        header.put(68, std::int16_t(1007));
        header.put_text(148, displacement_note);
    }
    put_place(header, grid);
    header.put_text(344, "n+1");
}

void NiftiFile::write(const std::filesystem::path& path) const {
    const std::span<const std::uint8_t> bytes(bytes_.get(), size_);
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        if (has_ending(path, ".gz"))
            write_bytes(temporary, gzipped(bytes));
        else
            write_bytes(temporary, bytes);
    });
}

}  // namespace palpate
