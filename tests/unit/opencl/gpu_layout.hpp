// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/backends/opencl/context.hpp"

namespace palpate {

/// Whatever device there is, with kernels in the layout for GPUs.
inline std::shared_ptr<OpenclDevice> open_as_gpu() {
    const std::shared_ptr<OpenclDevice> opened = open_device("");
    auto gpu = std::make_shared<OpenclDevice>();
    gpu->info = opened->info;
    gpu->device = opened->device;
    gpu->context = opened->context;
    gpu->queue = opened->queue;
    gpu->programs =
        std::make_unique<ProgramCache>(gpu->context, gpu->device, default_cache_folder());
    gpu->is_cpu = false;
    gpu->has_double = opened->has_double;
    gpu->max_allocation = opened->max_allocation;
    return gpu;
}

}  // namespace palpate
