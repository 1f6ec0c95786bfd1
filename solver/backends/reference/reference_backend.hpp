// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "solver/backend/backend.hpp"
#include "solver/backend/registry.hpp"

namespace palpate {

/// The oracle of every other back end: Eigen and plain loops on one host thread, always fp64 (what
/// `describe()` says, whatever precision was asked for). `Product::assembled` multiplies with an
/// Eigen sparse matrix, `Product::matrix_free` loops over the elements.
std::unique_ptr<Backend> make_reference_backend(const BackendOptions& options);

/// The host, as one device.
std::vector<DeviceInfo> reference_devices();

}  // namespace palpate
