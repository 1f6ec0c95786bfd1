// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "solver/backend/product_choice.hpp"
#include "solver/backend/registry.hpp"
#include "solver/backends/opencl/opencl_api.hpp"
#include "solver/backends/opencl/program_cache.hpp"

namespace palpate {

/// One device, opened: what all back-end objects on it share. Programs are built once per process.
struct OpenclDevice {
    DeviceInfo info;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;  ///< in order, shared by all precisions
    std::unique_ptr<ProgramCache> programs;
    ProductChoices choices;  ///< of Product::automatic, also kept beside the programs
    bool is_cpu = false;
    bool has_double = false;
    std::size_t max_allocation = 0;  ///< bytes in one buffer
};

/// The device named by `wanted` (see `choose_device`), opened at the first request and kept until
/// the process ends: drivers take badly to being closed in exit handlers, and condensation makes
/// many back-end objects one after the other. Thread-safe.
std::shared_ptr<OpenclDevice> open_device(const std::string& wanted);

}  // namespace palpate
