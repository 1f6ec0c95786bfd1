// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/decode_volume.hpp"

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <cstring>
#include <fstream>
#include <string>

#include "host/io/files.hpp"
#include "host/io/grid_check.hpp"
#include "host/system/forked_work.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// What the child hands over before the values.
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

template <typename T, typename Value>
void convert_from(const std::byte* raw, std::size_t count, Converted<Value> converted,
                  Value* values) {
    for (std::size_t n = 0; n < count; ++n) {
        T number;
        std::memcpy(&number, raw + n * sizeof(T), sizeof(T));
        values[n] = converted(static_cast<double>(number), n);
    }
}

template <typename Value>
void convert(itk::IOComponentEnum type, const std::byte* raw, std::size_t count,
             Converted<Value> converted, Value* values) {
    using Type = itk::IOComponentEnum;
    switch (type) {
        case Type::UCHAR:
            return convert_from<unsigned char>(raw, count, converted, values);
        case Type::CHAR:
            return convert_from<signed char>(raw, count, converted, values);
        case Type::USHORT:
            return convert_from<unsigned short>(raw, count, converted, values);
        case Type::SHORT:
            return convert_from<short>(raw, count, converted, values);
        case Type::UINT:
            return convert_from<unsigned>(raw, count, converted, values);
        case Type::INT:
            return convert_from<int>(raw, count, converted, values);
        case Type::ULONG:
            return convert_from<unsigned long>(raw, count, converted, values);
        case Type::LONG:
            return convert_from<long>(raw, count, converted, values);
        case Type::ULONGLONG:
            return convert_from<unsigned long long>(raw, count, converted, values);
        case Type::LONGLONG:
            return convert_from<long long>(raw, count, converted, values);
        case Type::FLOAT:
            return convert_from<float>(raw, count, converted, values);
        case Type::DOUBLE:
            return convert_from<double>(raw, count, converted, values);
        default:
            detail::unusable("its voxels are not plain numbers");
    }
}

/// Runs in the child.
template <typename Value>
void decode(const std::filesystem::path& file, const CheckedVolume& checked, Geometry& geometry,
            Converted<Value> converted, Value* values) {
    const itk::ImageIOBase::Pointer decoder = make_decoder(checked.format);
    decoder->SetFileName(file.string());
    decoder->ReadImageInformation();
    if (decoder->GetNumberOfComponents() != checked.components) {
        detail::unusable("it has " + std::to_string(decoder->GetNumberOfComponents()) +
                         " numbers per voxel, not " + std::to_string(checked.components));
    }
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
    const std::size_t count = region.GetNumberOfPixels() * checked.components;
    if (raw.size() != count * decoder->GetComponentSize()) {
        detail::unreadable("the decoder gave too few voxels");
    }
    convert(decoder->GetComponentType(), raw.data(), count, converted, values);
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

template <typename Value>
DecodedVolume<Value> decode_in_child(CheckedVolume checked, Converted<Value> converted,
                                     const ProgressSink& progress) {
    const PrivateFolder folder;
    const std::filesystem::path file = folder.path() / checked.file.name;
    write_file(file, checked.file.bytes);
    checked.file.bytes = {};
    const std::size_t count = std::size_t(checked.size[0]) * std::size_t(checked.size[1]) *
                              std::size_t(checked.size[2]) * checked.components;
    const SharedMemory memory(sizeof(Geometry) + count * sizeof(Value));
    auto& geometry = *reinterpret_cast<Geometry*>(memory.data());
    auto* values = reinterpret_cast<Value*>(memory.data() + sizeof(Geometry));
    ReadingLimits limits;
    limits.memory_bytes = (std::size_t(256) << 20) + 32 * count;  // decoder, its copy, conversion
    limits.seconds = 60 + static_cast<int>(count >> 22);
    run_in_child([&] { decode(file, checked, geometry, converted, values); }, limits,
                 [&] { check_cancelled(progress); });
    DecodedVolume<Value> volume;
    volume.grid = checked.grid ? *checked.grid : grid_from(geometry, checked.size);
    volume.values.assign(values, values + count);
    return volume;
}

}  // namespace

template <typename Value>
DecodedVolume<Value> decode_volume(const std::filesystem::path& path, CheckedVolume checked,
                                   Converted<Value> converted, const ProgressSink& progress) {
    check_cancelled(progress);
    try {
        return decode_in_child(std::move(checked), converted, progress);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::cancelled) throw;
        throw Error(error.code(), "cannot use '" + path.string() + "': " + error.what());
    }
}

template DecodedVolume<std::uint16_t> decode_volume(const std::filesystem::path&, CheckedVolume,
                                                    Converted<std::uint16_t>, const ProgressSink&);
template DecodedVolume<float> decode_volume(const std::filesystem::path&, CheckedVolume,
                                            Converted<float>, const ProgressSink&);

}  // namespace palpate
