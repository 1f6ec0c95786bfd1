// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "solver/backend/backend.hpp"

namespace palpate {

struct OpenclDevice;

/// The back end on one OpenCL 1.2 device. Throws Error(device_unavailable) if there is no such
/// device, Error(unsupported) for double precision on a device without it.
/// One object belongs to one thread at a time; different objects may run in different threads.
std::unique_ptr<Backend> make_opencl_backend(const BackendOptions& options);

/// The same on a device that is open already; `options.device` is not read.
std::unique_ptr<Backend> make_opencl_backend_on(std::shared_ptr<OpenclDevice> device,
                                                const BackendOptions& options);

}  // namespace palpate
