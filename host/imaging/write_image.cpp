// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <type_traits>

#include "host/imaging/child_process.hpp"
#include "host/imaging/files.hpp"
#include "host/imaging/io.hpp"
#include "host/imaging/preflight.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

itk::ImageIOBase::Pointer make_encoder(const std::filesystem::path& path) {
    const auto format = format_of(path);
    const std::string ending = path.extension().string();
    if (!format || ending == ".mhd" || ending == ".nhdr") {
        throw Error(ErrorCode::unsupported,
                    "cannot write '" + path.string() + "': use .nii, .nii.gz, .nrrd or .mha");
    }
    switch (*format) {
        case VolumeFormat::nifti:
            return itk::NiftiImageIO::New().GetPointer();
        case VolumeFormat::nrrd:
            return itk::NrrdImageIO::New().GetPointer();
        case VolumeFormat::meta:
            return itk::MetaImageIO::New().GetPointer();
    }
    throw Error(ErrorCode::internal, "a volume format without an encoder");
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
void write_volume(const std::filesystem::path& path, const ImageGrid& grid,
                  const std::vector<T>& values, unsigned num_components) {
    if (values.size() != grid.num_voxels() * num_components) {
        throw Error(ErrorCode::invalid_argument,
                    "an image of " + std::to_string(grid.num_voxels()) + " voxels cannot have " +
                        std::to_string(values.size()) + " values");
    }
    const itk::ImageIOBase::Pointer encoder = make_encoder(path);
    describe(*encoder, grid);
    encoder->SetNumberOfComponents(num_components);
    encoder->SetPixelType(num_components == 1 ? itk::IOPixelEnum::SCALAR
                                              : itk::IOPixelEnum::VECTOR);
    encoder->SetComponentType(component_type<T>());
    encoder->SetUseCompression(true);
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        encoder->SetFileName(temporary.string());
        write_in_child(
            [&] {
                encoder->WriteImageInformation();
                encoder->Write(values.data());
            },
            values.size() * sizeof(T));
        // The encoder does not notice a full disk; the check of a reader does.
        num_components == 1 ? preflight(temporary) : preflight_vectors(temporary);
    });
}

}  // namespace

void write_label_image(const std::filesystem::path& path, const LabelImage& image) {
    const bool is_small = std::all_of(image.voxels.begin(), image.voxels.end(),
                                      [](std::uint16_t label) { return label < 256; });
    if (is_small) {
        const std::vector<std::uint8_t> bytes(image.voxels.begin(), image.voxels.end());
        write_volume(path, image.grid, bytes, 1);
    } else {
        write_volume(path, image.grid, image.voxels, 1);
    }
}

void write_scalar_image(const std::filesystem::path& path, const Image<float>& image) {
    write_volume(path, image.grid, image.voxels, 1);
}

void write_vector_image(const std::filesystem::path& path, const Image<Vec3>& image) {
    if (format_of(path) != VolumeFormat::nifti) {
        throw Error(ErrorCode::unsupported,
                    "cannot write '" + path.string() + "': a vector image is .nii or .nii.gz");
    }
    std::vector<float> values;
    values.reserve(3 * image.voxels.size());
    for (const Vec3& v : image.voxels) {
        for (int a = 0; a < 3; ++a) values.push_back(static_cast<float>(v[a]));
    }
    write_volume(path, image.grid, values, 3);
}

}  // namespace palpate
