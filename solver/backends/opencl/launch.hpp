// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/backends/opencl/opencl_api.hpp"
#include "solver/backends/opencl/work_size.hpp"

namespace palpate {

/// Starts `kernel` on `size` work items with `args` in the order of its parameters: buffers, or
/// numbers of exactly the parameter's type (cl_int, cl_ulong, cl_float, ...). A missing, surplus or
/// wrongly sized argument is an error of the OpenCL call. The kernel's parameters are shared state:
/// one kernel object belongs to one thread.
template <class... Args>
void launch(const cl::CommandQueue& queue, cl::Kernel& kernel, const WorkSize& size,
            const Args&... args) {
    if (size.rows == 0 || size.column_groups == 0) return;
    cl_uint position = 0;
    (kernel.setArg(position++, args), ...);
    queue.enqueueNDRangeKernel(kernel, cl::NullRange,
                               cl::NDRange(size.global_columns(), size.global_rows()),
                               cl::NDRange(size.group.columns, size.group.rows));
}

}  // namespace palpate
