// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <string>

#include "host/imaging/child_process.hpp"
#include "host/imaging/files.hpp"
#include "host/imaging/grid_check.hpp"
#include "host/imaging/io.hpp"
#include "host/imaging/preflight.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Label = decltype(LabelImage::voxels)::value_type;

/// What the child hands over before the labels.
struct Geometry {
    double origin[3], spacing[3], direction[9];  ///< direction by columns
};

itk::ImageIOBase::Pointer make_decoder(VolumeFormat format) {
    switch (format) {
        case VolumeFormat::nifti:
            return itk::NiftiImageIO::New().GetPointer();
        case VolumeFormat::nrrd:
            return itk::NrrdImageIO::New().GetPointer();
        case VolumeFormat::meta:
            return itk::MetaImageIO::New().GetPointer();
    }
    throw Error(ErrorCode::internal, "a volume format without a decoder");
}

template <typename T>
void convert(const std::byte* raw, std::size_t count, Label* labels) {
    for (std::size_t n = 0; n < count; ++n) {
        T value;
        std::memcpy(&value, raw + n * sizeof(T), sizeof(T));
        const double number = static_cast<double>(value), nearest = std::round(number);
        if (!(std::abs(number - nearest) <= 1e-3) || nearest < 0 || nearest > 65535) {
            throw Error(ErrorCode::input_unusable,
                        "voxel " + std::to_string(n) + " has the value " + std::to_string(number) +
                            "; labels are whole numbers from 0 to 65535");
        }
        labels[n] = static_cast<Label>(nearest);
    }
}

void convert(itk::IOComponentEnum type, const std::byte* raw, std::size_t count, Label* labels) {
    using Type = itk::IOComponentEnum;
    switch (type) {
        case Type::UCHAR:
            return convert<unsigned char>(raw, count, labels);
        case Type::CHAR:
            return convert<signed char>(raw, count, labels);
        case Type::USHORT:
            return convert<unsigned short>(raw, count, labels);
        case Type::SHORT:
            return convert<short>(raw, count, labels);
        case Type::UINT:
            return convert<unsigned>(raw, count, labels);
        case Type::INT:
            return convert<int>(raw, count, labels);
        case Type::ULONG:
            return convert<unsigned long>(raw, count, labels);
        case Type::LONG:
            return convert<long>(raw, count, labels);
        case Type::ULONGLONG:
            return convert<unsigned long long>(raw, count, labels);
        case Type::LONGLONG:
            return convert<long long>(raw, count, labels);
        case Type::FLOAT:
            return convert<float>(raw, count, labels);
        case Type::DOUBLE:
            return convert<double>(raw, count, labels);
        default:
            detail::unusable("its voxels are not plain numbers");
    }
}

/// Runs in the child.
void decode(const std::filesystem::path& file, const CheckedVolume& checked, Geometry& geometry,
            Label* labels) {
    const itk::ImageIOBase::Pointer decoder = make_decoder(checked.format);
    decoder->SetFileName(file.string());
    decoder->ReadImageInformation();
    if (decoder->GetNumberOfComponents() != 1) detail::unusable("it has several numbers per voxel");
    const unsigned num_dims = decoder->GetNumberOfDimensions();
    if (num_dims != 3) detail::unusable("it is not a volume of three dimensions");
    itk::ImageIORegion region(num_dims);
    for (unsigned a = 0; a < 3; ++a) {
        if (decoder->GetDimensions(a) != std::size_t(checked.size[a])) {
            detail::unreadable("the decoder disagrees with its header about the extent");
        }
        region.SetIndex(a, 0);
        region.SetSize(a, decoder->GetDimensions(a));
        geometry.origin[a] = decoder->GetOrigin(a);
        geometry.spacing[a] = decoder->GetSpacing(a);
        const std::vector<double> axis = decoder->GetDirection(a);
        std::copy_n(axis.begin(), 3, geometry.direction + 3 * a);
    }
    decoder->SetIORegion(region);
    std::vector<std::byte> raw(decoder->GetImageSizeInBytes());
    decoder->Read(raw.data());
    const std::size_t count = region.GetNumberOfPixels();
    if (raw.size() != count * decoder->GetComponentSize()) {
        detail::unreadable("the decoder gave too few voxels");
    }
    convert(decoder->GetComponentType(), raw.data(), count, labels);
}

void write_file(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes) {
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) {
        throw Error(ErrorCode::output_failed,
                    "the temporary folder has no space for a copy; set TMPDIR to another one");
    }
}

ImageGrid grid_from(const Geometry& geometry, const std::array<Index, 3>& size) {
    ImageGrid grid;
    grid.size = size;
    grid.origin = Eigen::Map<const Vec3>(geometry.origin);
    grid.spacing = Eigen::Map<const Vec3>(geometry.spacing);
    grid.direction = Eigen::Map<const Mat3>(geometry.direction);  // column by column
    return checked_grid(grid);
}

LabelImage decode_in_child(CheckedVolume checked, const ProgressSink& progress) {
    const PrivateFolder folder;
    const std::filesystem::path file = folder.path() / checked.file.name;
    write_file(file, checked.file.bytes);
    checked.file.bytes = {};
    const std::size_t count =
        std::size_t(checked.size[0]) * std::size_t(checked.size[1]) * std::size_t(checked.size[2]);
    const SharedMemory memory(sizeof(Geometry) + count * sizeof(Label));
    auto& geometry = *reinterpret_cast<Geometry*>(memory.data());
    auto* labels = reinterpret_cast<Label*>(memory.data() + sizeof(Geometry));
    ReadingLimits limits;
    limits.memory_bytes = (std::size_t(256) << 20) + 32 * count;  // decoder, its copy, conversion
    limits.seconds = 60 + static_cast<int>(count >> 22);
    run_in_child([&] { decode(file, checked, geometry, labels); }, limits,
                 [&] { check_cancelled(progress); });
    LabelImage image;
    image.grid = checked.grid ? *checked.grid : grid_from(geometry, checked.size);
    image.voxels.assign(labels, labels + count);
    return image;
}

}  // namespace

LabelImage read_label_image(const std::filesystem::path& path, const ProgressSink& progress,
                            std::vector<std::string>* warnings) {
    CheckedVolume checked = preflight(path);
    if (warnings) *warnings = checked.warnings;
    check_cancelled(progress);
    try {
        return decode_in_child(std::move(checked), progress);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::cancelled) throw;
        throw Error(error.code(), "cannot use '" + path.string() + "': " + error.what());
    }
}

}  // namespace palpate
