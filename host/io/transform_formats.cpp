// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/transform_formats.hpp"

#include <itkHDF5TransformIOFactory.h>
#include <itkTransformFactoryBase.h>
#include <itkTxtTransformIOFactory.h>

#include <mutex>

namespace palpate {

void register_transform_formats() {
    static std::once_flag done;
    std::call_once(done, [] {
        itk::TransformFactoryBase::RegisterDefaultTransforms();
        itk::TxtTransformIOFactory::RegisterOneFactory();
        itk::HDF5TransformIOFactory::RegisterOneFactory();
    });
}

}  // namespace palpate
