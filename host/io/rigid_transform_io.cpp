// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <itkObjectFactoryBase.h>
#include <itkTransformBase.h>
#include <itkTransformFileReader.h>
#include <itkTransformFileWriter.h>
#include <itkVersorRigid3DTransform.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "host/io/files.hpp"
#include "host/io/preflight.hpp"
#include "host/io/transform_formats.hpp"
#include "host/io/volume_files.hpp"
#include "host/system/forked_work.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

[[noreturn]] void unusable(const std::string& reason) {
    throw Error(ErrorCode::input_unusable, reason);
}

Vec3 image_of(const itk::Transform<double, 3, 3>& transform, const Vec3& x) {
    itk::Point<double, 3> point;
    for (unsigned a = 0; a < 3; ++a) point[a] = x[a];
    const auto moved = transform.TransformPoint(point);
    return Vec3(moved[0], moved[1], moved[2]);
}

/// As ITK reads them: up to the first word that is none.
std::size_t count_numbers(const std::string& text) {
    std::istringstream words(text);
    std::size_t count = 0;
    for (double number; words >> number;) ++count;
    return count;
}

/// ITK's reader of text takes from memory what lacks behind "Parameters:".
void check_numbers_of_text(const std::filesystem::path& path) {
    using Base = itk::TransformBaseTemplate<double>;
    std::ifstream file(path);
    Base::Pointer transform;
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = std::min(line.find(':'), line.size());
        const std::string key = detail::trimmed(line.substr(0, colon));
        const std::string value = colon < line.size() ? line.substr(colon + 1) : "";
        if (key == "Transform") {
            const std::string name = detail::trimmed(value);
            const auto made = itk::ObjectFactoryBase::CreateInstance(name.c_str());
            transform = dynamic_cast<Base*>(made.GetPointer());
            if (made) made->UnRegister();
        }
        const bool is_fixed = key == "FixedParameters";
        if (!transform || !(is_fixed || key == "Parameters")) continue;
        const std::size_t found = count_numbers(value);
        const std::size_t needed =
            is_fixed ? transform->GetFixedParameters().size() : transform->GetNumberOfParameters();
        if (found != needed)
            throw Error(ErrorCode::input_unreadable,
                        "it is damaged: a transform of it has " + std::to_string(found) +
                            " parameters, not " + std::to_string(needed));
    }
}

/// Runs in the child: y = matrix x + translation, 12 numbers, matrix by columns.
void read_linear(const std::filesystem::path& path, double* numbers) {
    register_transform_formats();
    const std::string ending = path.extension().string();
    if (ending == ".tfm" || ending == ".txt") check_numbers_of_text(path);
    const auto reader = itk::TransformFileReaderTemplate<double>::New();
    reader->SetFileName(path.string());
    reader->Update();
    const auto& transforms = *reader->GetTransformList();
    if (transforms.size() != 1) {
        unusable("it holds " + std::to_string(transforms.size()) + " transforms, one is needed");
    }
    const auto* transform =
        dynamic_cast<const itk::Transform<double, 3, 3>*>(transforms.front().GetPointer());
    if (!transform) unusable("its transform is not of three dimensions");
    if (!transform->IsLinear()) {
        unusable(std::string("its transform (") + transform->GetNameOfClass() + ") is not linear");
    }
    Eigen::Map<Vec3> translation(numbers + 9);
    Eigen::Map<Mat3> matrix(numbers);
    translation = image_of(*transform, Vec3::Zero());
    for (int a = 0; a < 3; ++a) {
        matrix.col(a) = image_of(*transform, Vec3::Unit(a)) - translation;
    }
}

RigidTransform rigid_from(const Mat3& matrix, const Vec3& translation) {
    if (!matrix.allFinite() || !translation.allFinite()) unusable("its numbers are not finite");
    const double error = (matrix.transpose() * matrix - Mat3::Identity()).cwiseAbs().maxCoeff();
    if (error > 1e-3 || matrix.determinant() < 0) {
        unusable("its matrix is not a rotation; scaling, shear and mirroring are not accepted");
    }
    const Eigen::JacobiSVD<Mat3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    return {svd.matrixU() * svd.matrixV().transpose(), translation};
}

bool has_known_ending(const std::filesystem::path& path) {
    const std::string ending = path.extension().string();
    return ending == ".tfm" || ending == ".txt" || ending == ".h5" || ending == ".hdf5";
}

}  // namespace

RigidTransform read_rigid_transform(const std::filesystem::path& path) {
    try {
        std::error_code error;
        if (!std::filesystem::is_regular_file(path, error)) {
            throw Error(ErrorCode::input_unreadable, "there is no such file");
        }
        if (!has_known_ending(path)) {
            throw Error(ErrorCode::input_unreadable,
                        "its format is unknown; use .tfm, .txt or .h5");
        }
        const SharedMemory memory(12 * sizeof(double));
        auto* numbers = reinterpret_cast<double*>(memory.data());
        run_in_child([&] { read_linear(path, numbers); });
        return rigid_from(Eigen::Map<const Mat3>(numbers), Eigen::Map<const Vec3>(numbers + 9));
    } catch (const Error& error) {
        throw Error(error.code(),
                    "cannot use the transform '" + path.string() + "': " + error.what());
    }
}

void write_rigid_transform(const std::filesystem::path& path, const RigidTransform& transform) {
    if (!has_known_ending(path)) {
        throw Error(ErrorCode::unsupported,
                    "cannot write '" + path.string() + "': a transform is .tfm, .txt or .h5");
    }
    register_transform_formats();
    const auto rigid = itk::VersorRigid3DTransform<double>::New();
    itk::VersorRigid3DTransform<double>::MatrixType matrix;
    itk::VersorRigid3DTransform<double>::OutputVectorType translation;
    for (unsigned r = 0; r < 3; ++r) {
        for (unsigned c = 0; c < 3; ++c) matrix(r, c) = transform.rotation(r, c);
        translation[r] = transform.translation[r];
    }
    write_atomically(path, [&](const std::filesystem::path& temporary) {
        rigid->SetMatrix(matrix, 1e-6);
        rigid->SetTranslation(translation);
        const auto writer = itk::TransformFileWriterTemplate<double>::New();
        writer->SetFileName(temporary.string());
        writer->SetInput(rigid);
        write_in_child([&] { writer->Update(); }, 0);
    });
}

}  // namespace palpate
