// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/opencl_api.hpp"

#include <fmt/format.h>

namespace palpate {
namespace {

const char* short_status_name(cl_int status) {
    switch (status) {
        case CL_DEVICE_NOT_FOUND:
            return "CL_DEVICE_NOT_FOUND";
        case CL_DEVICE_NOT_AVAILABLE:
            return "CL_DEVICE_NOT_AVAILABLE";
        case CL_COMPILER_NOT_AVAILABLE:
            return "CL_COMPILER_NOT_AVAILABLE";
        case CL_MEM_OBJECT_ALLOCATION_FAILURE:
            return "CL_MEM_OBJECT_ALLOCATION_FAILURE";
        case CL_OUT_OF_RESOURCES:
            return "CL_OUT_OF_RESOURCES";
        case CL_OUT_OF_HOST_MEMORY:
            return "CL_OUT_OF_HOST_MEMORY";
        case CL_BUILD_PROGRAM_FAILURE:
            return "CL_BUILD_PROGRAM_FAILURE";
        case CL_INVALID_VALUE:
            return "CL_INVALID_VALUE";
        case CL_INVALID_CONTEXT:
            return "CL_INVALID_CONTEXT";
        case CL_INVALID_MEM_OBJECT:
            return "CL_INVALID_MEM_OBJECT";
        case CL_INVALID_BINARY:
            return "CL_INVALID_BINARY";
        case CL_INVALID_BUILD_OPTIONS:
            return "CL_INVALID_BUILD_OPTIONS";
        case CL_INVALID_KERNEL_NAME:
            return "CL_INVALID_KERNEL_NAME";
        case CL_INVALID_ARG_INDEX:
            return "CL_INVALID_ARG_INDEX";
        case CL_INVALID_ARG_SIZE:
            return "CL_INVALID_ARG_SIZE";
        case CL_INVALID_KERNEL_ARGS:
            return "CL_INVALID_KERNEL_ARGS";
        case CL_INVALID_WORK_GROUP_SIZE:
            return "CL_INVALID_WORK_GROUP_SIZE";
        case CL_INVALID_BUFFER_SIZE:
            return "CL_INVALID_BUFFER_SIZE";
        case -1001:
            return "no OpenCL platform";
        default:
            return "OpenCL error";
    }
}

bool is_out_of_memory(cl_int status) {
    return status == CL_MEM_OBJECT_ALLOCATION_FAILURE || status == CL_OUT_OF_HOST_MEMORY ||
           status == CL_INVALID_BUFFER_SIZE;
}

}  // namespace

std::string opencl_status_name(cl_int status) {
    return fmt::format("{} ({})", short_status_name(status), status);
}

Error opencl_error(const cl::Error& error, const std::string& task) {
    const std::string what =
        fmt::format("{} reported {}", error.what(), opencl_status_name(error.err()));
    if (is_out_of_memory(error.err()))
        return Error(
            ErrorCode::out_of_memory,
            fmt::format("The OpenCL device ran out of memory while trying to {}: {}; use a "
                        "coarser mesh, fewer columns or another device.",
                        task, what));
    return Error(ErrorCode::device_failed,
                 fmt::format("The OpenCL device failed while trying to {}: {}; try another device "
                             "(list them with `palpate devices`) or the reference back end.",
                             task, what));
}

}  // namespace palpate
