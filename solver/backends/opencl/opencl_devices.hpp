// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solver/backend/registry.hpp"

namespace palpate {

/// Every OpenCL device of this machine; empty if there is no driver.
std::vector<DeviceInfo> opencl_devices();

}  // namespace palpate
