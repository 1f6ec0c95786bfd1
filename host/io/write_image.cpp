// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "host/io/displacement_steps.hpp"
#include "host/io/files.hpp"
#include "host/io/nifti_file.hpp"
#include "host/io/preflight.hpp"
#include "host/io/volume_files.hpp"
#include "host/system/forked_work.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

VolumeFormat checked_format(const std::filesystem::path& path) {
    const auto format = format_of(path);
    if (!format || has_ending(path, ".mhd") || has_ending(path, ".nhdr")) {
        throw Error(ErrorCode::unsupported,
                    "cannot write '" + path.string() + "': use .nii, .nii.gz, .nrrd or .mha");
    }
    return *format;
}

itk::ImageIOBase::Pointer make_encoder(VolumeFormat format) {
    if (format == VolumeFormat::nrrd) return itk::NrrdImageIO::New().GetPointer();
    return itk::MetaImageIO::New().GetPointer();
}

void describe(itk::ImageIOBase& encoder, const ImageGrid& grid) {
    encoder.SetNumberOfDimensions(3);
    itk::ImageIORegion region(3);
    for (unsigned a = 0; a < 3; ++a) {
        encoder.SetDimensions(a, static_cast<itk::SizeValueType>(grid.size[a]));
        encoder.SetSpacing(a, grid.spacing[a]);
        encoder.SetOrigin(a, grid.origin[a]);
        const Vec3 axis = grid.direction.col(a);
        encoder.SetDirection(a, std::vector<double>{axis[0], axis[1], axis[2]});
        region.SetIndex(a, 0);
        region.SetSize(a, static_cast<itk::SizeValueType>(grid.size[a]));
    }
    encoder.SetIORegion(region);
}

template <typename T>
itk::IOComponentEnum component_type() {
    if constexpr (std::is_same_v<T, std::uint8_t>)
        return itk::IOComponentEnum::UCHAR;
    else if constexpr (std::is_same_v<T, std::uint16_t>)
        return itk::IOComponentEnum::USHORT;
    else
        return itk::IOComponentEnum::FLOAT;
}

template <typename T>
void write_nifti(const std::filesystem::path& path, const ImageGrid& grid,
                 const std::vector<T>& values) {
    constexpr NiftiNumbers kind = std::is_same_v<T, std::uint8_t>    ? NiftiNumbers::bytes
                                  : std::is_same_v<T, std::uint16_t> ? NiftiNumbers::words
                                                                     : NiftiNumbers::singles;
    NiftiFile file(grid, kind);
    std::copy(values.begin(), values.end(), file.numbers<T>());
    file.write(path);
}

/// An encoder does not notice a full disk; the check of a reader does.
void check_encoded(const std::filesystem::path& path) {
    try {
        preflight(path);
    } catch (const Error&) {
        throw Error(ErrorCode::output_failed, "it could not be written whole");
    }
}

template <typename T>
void write_volume(const std::filesystem::path& path, const ImageGrid& grid,
                  const std::vector<T>& values) {
    if (values.size() != grid.num_voxels()) {
        throw Error(ErrorCode::invalid_argument,
                    "an image of " + std::to_string(grid.num_voxels()) + " voxels cannot have " +
                        std::to_string(values.size()) + " values");
    }
    const VolumeFormat format = checked_format(path);
    if (format == VolumeFormat::nifti) return write_nifti(path, grid, values);
    const itk::ImageIOBase::Pointer encoder = make_encoder(format);
    describe(*encoder, grid);
    encoder->SetNumberOfComponents(1);
    encoder->SetPixelType(itk::IOPixelEnum::SCALAR);
    encoder->SetComponentType(component_type<T>());
    encoder->SetUseCompression(true);
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        // Encoders know their endings in lower case only.
        std::filesystem::path encoded = temporary;
        encoded.replace_extension(format == VolumeFormat::nrrd ? ".nrrd" : ".mha");
        encoder->SetFileName(encoded.string());
        write_in_child(
            [&] {
                encoder->WriteImageInformation();
                encoder->Write(values.data());
            },
            values.size() * sizeof(T));
        check_encoded(encoded);
        std::filesystem::rename(encoded, temporary);
    });
}

}  // namespace

void write_label_image(const std::filesystem::path& path, const LabelImage& image) {
    const bool is_small = std::all_of(image.voxels.begin(), image.voxels.end(),
                                      [](std::uint16_t label) { return label < 256; });
    if (is_small) {
        const std::vector<std::uint8_t> bytes(image.voxels.begin(), image.voxels.end());
        write_volume(path, image.grid, bytes);
    } else {
        write_volume(path, image.grid, image.voxels);
    }
}

void write_scalar_image(const std::filesystem::path& path, const Image<float>& image) {
    const auto is_finite = [](float value) { return std::isfinite(value); };
    if (!std::all_of(image.voxels.begin(), image.voxels.end(), is_finite)) {
        throw Error(ErrorCode::output_failed,
                    "cannot write '" + path.string() + "': it has a voxel that is not finite");
    }
    write_volume(path, image.grid, image.voxels);
}

void write_vector_image(const std::filesystem::path& path, const Image<Vec3>& image) {
    if (format_of(path) != VolumeFormat::nifti) {
        throw Error(ErrorCode::unsupported,
                    "cannot write '" + path.string() + "': a vector image is .nii or .nii.gz");
    }
    check_displacement(image);
    NiftiFile file(image.grid, NiftiNumbers::displacements);
    const std::size_t count = image.voxels.size();
    auto* numbers = file.numbers<float>();
    for (std::size_t v = 0; v < count; ++v)
        for (int a = 0; a < 3; ++a)
            numbers[std::size_t(a) * count + v] = in_steps(image.voxels[v][a]);
    file.write(path);
}

}  // namespace palpate
