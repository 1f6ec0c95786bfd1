// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "solver/backend/registry.hpp"

namespace palpate {

/// Position in `devices` of the device that `wanted` names: "platform.device" numbers such as
/// "0.1", or a part of the device name (case does not matter); empty: the first GPU, else the first
/// CPU, else the first of all. Throws Error(device_unavailable) saying what there is and what to
/// do.
std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& wanted);

}  // namespace palpate
