// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "solver/backend/backend.hpp"
#include "solver/backend/registry.hpp"

namespace palpate {

/// Whatever Kokkos was built for: one host thread, OpenMP, CUDA or HIP, from the same source.
/// Vectors of both precisions live in one memory. `options.device` may only name the one device.
/// Throws Error(device_unavailable) where Kokkos does not start.
std::unique_ptr<Backend> make_kokkos_backend(const BackendOptions& options);

/// Kokkos' default execution space as one device; none where it does not start.
std::vector<DeviceInfo> kokkos_devices();

}  // namespace palpate
