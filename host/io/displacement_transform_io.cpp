// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <itkDisplacementFieldTransform.h>
#include <itkHDF5TransformIO.h>
#include <itkTransformFileReader.h>
#include <itkTransformFileWriter.h>

#include <cmath>
#include <cstring>
#include <string>

#include "host/io/displacement_steps.hpp"
#include "host/io/files.hpp"
#include "host/io/grid_check.hpp"
#include "host/io/preflight.hpp"
#include "host/io/transform_formats.hpp"
#include "host/io/volume_files.hpp"
#include "host/system/forked_work.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

using Written = itk::DisplacementFieldTransform<float, 3>;
using Read = itk::DisplacementFieldTransform<double, 3>;

Written::DisplacementFieldType::Pointer itk_field(const Image<Vec3>& image) {
    const auto field = Written::DisplacementFieldType::New();
    Written::DisplacementFieldType::RegionType region;
    Written::DisplacementFieldType::DirectionType direction;
    for (unsigned a = 0; a < 3; ++a) {
        region.SetSize(a, static_cast<itk::SizeValueType>(image.grid.size[a]));
        for (unsigned b = 0; b < 3; ++b) direction(a, b) = image.grid.direction(a, b);
    }
    field->SetRegions(region);
    field->SetOrigin(image.grid.origin.data());
    field->SetSpacing(image.grid.spacing.data());
    field->SetDirection(direction);
    field->Allocate();
    auto* values = field->GetBufferPointer();
    for (std::size_t v = 0; v < image.voxels.size(); ++v) {
        for (unsigned a = 0; a < 3; ++a) values[v][a] = in_steps(image.voxels[v][a]);
    }
    return field;
}

/// What the child finds before it knows how much memory the vectors need.
struct FieldGeometry {
    Index size[3];
    double origin[3], spacing[3], direction[9];  ///< direction by columns
};

Read::DisplacementFieldType::ConstPointer field_in(const std::filesystem::path& path) {
    register_transform_formats();
    const auto reader = itk::TransformFileReaderTemplate<double>::New();
    reader->SetFileName(path.string());
    reader->Update();
    const auto& transforms = *reader->GetTransformList();
    if (transforms.size() != 1) {
        detail::unusable("it holds " + std::to_string(transforms.size()) +
                         " transforms; one displacement field is needed");
    }
    const auto* transform = dynamic_cast<const Read*>(transforms.front().GetPointer());
    if (!transform || !transform->GetDisplacementField()) {
        detail::unusable(std::string("its transform (") + transforms.front()->GetNameOfClass() +
                         ") is not a displacement field of three dimensions");
    }
    return transform->GetDisplacementField();
}

/// Runs in the child.
void read_geometry(const std::filesystem::path& path, FieldGeometry& geometry) {
    const auto field = field_in(path);
    const auto region = field->GetBufferedRegion();
    std::vector<long long> sizes;
    for (unsigned a = 0; a < 3; ++a) {
        sizes.push_back(static_cast<long long>(region.GetSize(a)));
        geometry.size[a] = static_cast<Index>(region.GetSize(a));
        geometry.origin[a] = field->GetOrigin()[a];
        geometry.spacing[a] = field->GetSpacing()[a];
        for (unsigned b = 0; b < 3; ++b)
            geometry.direction[3 * a + b] = field->GetDirection()(b, a);
    }
    detail::checked_num_voxels(sizes);
}

/// Runs in the child.
void read_vectors(const std::filesystem::path& path, std::size_t num_voxels, float* values) {
    const auto field = field_in(path);
    if (field->GetBufferedRegion().GetNumberOfPixels() != num_voxels) {
        detail::unreadable("it changed while it was read");
    }
    const auto* vectors = field->GetBufferPointer();
    for (std::size_t v = 0; v < num_voxels; ++v) {
        for (unsigned a = 0; a < 3; ++a) {
            const float value = static_cast<float>(vectors[v][a]);
            if (!std::isfinite(value)) {
                detail::unusable("it has a vector that is not finite (voxel " + std::to_string(v) +
                                 ")");
            }
            values[3 * v + a] = value;
        }
    }
}

/// The checks of the file's size come before the child has read it, so its memory is bounded here,
/// and its time: HDF5 goes round in circles in some damaged files.
ReadingLimits limits_of(const std::filesystem::path& path) {
    std::error_code error;
    auto bytes = std::filesystem::file_size(path, error);
    if (error) bytes = 0;
    ReadingLimits limits;
    constexpr std::size_t most_per_byte = 512;  // fields compress to a seventh and much less
    limits.memory_bytes = (std::size_t(1) << 30) + most_per_byte * static_cast<std::size_t>(bytes);
    limits.seconds = 4 + static_cast<int>(bytes >> 20);  // ten times what good ones take
    return limits;
}

Image<Vec3> read_checked(const std::filesystem::path& path) {
    if (const auto why = why_unreadable(path)) detail::unreadable(*why);
    if (!is_transform_file(path)) detail::unreadable("a displacement transform is .h5 or .hdf5");
    const ReadingLimits limits = limits_of(path);
    const SharedMemory head(sizeof(FieldGeometry));
    auto& geometry = *reinterpret_cast<FieldGeometry*>(head.data());
    run_in_child([&] { read_geometry(path, geometry); }, limits);
    Image<Vec3> image;
    image.grid.size = {geometry.size[0], geometry.size[1], geometry.size[2]};
    image.grid.origin = Eigen::Map<const Vec3>(geometry.origin);
    image.grid.spacing = Eigen::Map<const Vec3>(geometry.spacing);
    image.grid.direction = Eigen::Map<const Mat3>(geometry.direction);
    image.grid = checked_grid(image.grid);
    const std::size_t num_voxels = image.grid.num_voxels();
    const SharedMemory body(3 * num_voxels * sizeof(float));
    const auto* values = reinterpret_cast<float*>(body.data());
    run_in_child([&] { read_vectors(path, num_voxels, reinterpret_cast<float*>(body.data())); },
                 limits);
    image.voxels.reserve(num_voxels);
    for (std::size_t v = 0; v < num_voxels; ++v) {
        image.voxels.emplace_back(values[3 * v], values[3 * v + 1], values[3 * v + 2]);
    }
    return image;
}

}  // namespace

bool is_transform_file(const std::filesystem::path& path) {
    return has_ending(path, ".h5") || has_ending(path, ".hdf5");
}

Image<Vec3> read_displacement_transform(const std::filesystem::path& path) {
    try {
        return read_checked(path);
    } catch (const Error& error) {
        throw Error(error.code(),
                    "cannot use the transform '" + path.string() + "': " + error.what());
    }
}

void write_displacement_transform(const std::filesystem::path& path, const Image<Vec3>& image) {
    if (!is_transform_file(path)) {
        throw Error(ErrorCode::unsupported, "cannot write '" + path.string() +
                                                "': a displacement transform is .h5 or .hdf5");
    }
    check_displacement(image);
    register_transform_formats();
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        const auto transform = Written::New();
        transform->SetDisplacementField(itk_field(image));
        const auto writer = itk::TransformFileWriterTemplate<float>::New();
        writer->SetFileName(temporary.string());
        writer->SetTransformIO(itk::HDF5TransformIOTemplate<float>::New());  // for .H5, too
        writer->SetInput(transform);
        writer->UseCompressionOn();
        write_in_child([&] { writer->Update(); }, 3 * sizeof(float) * image.voxels.size());
    });
}

}  // namespace palpate
