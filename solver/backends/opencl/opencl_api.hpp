// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The only place that includes the OpenCL headers: the C++ bindings for OpenCL 1.2, errors as
// exceptions of type cl::Error, which never leave this folder (see `guarded`).
#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/opencl.hpp>
#include <new>
#include <utility>

#include "solver/base/error.hpp"

namespace palpate {

/// Name of an OpenCL status: "CL_OUT_OF_RESOURCES (-5)".
std::string opencl_status_name(cl_int status);

/// The palpate error for a failed OpenCL call while doing `task` ("multiply with the stiffness").
Error opencl_error(const cl::Error& error, const std::string& task);

/// Runs `body` and turns cl::Error into palpate::Error: out_of_memory or device_failed.
template <class Body>
decltype(auto) guarded(const char* task, Body&& body) {
    try {
        return std::forward<Body>(body)();
    } catch (const cl::Error& error) {
        throw opencl_error(error, task);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::out_of_memory, std::string("Host memory ran out while trying to ") +
                                                  task + ": use a coarser mesh or fewer columns.");
    }
}

}  // namespace palpate
