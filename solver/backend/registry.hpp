// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "solver/backend/backend.hpp"

namespace palpate {

/// One device that a back end can use.
struct DeviceInfo {
    std::string backend;  ///< "opencl"
    std::string id;       ///< what `--device` takes: "0.1" = platform 0, device 1
    std::string platform;
    std::string name;
    std::string type;  ///< "CPU", "GPU", "accelerator", "host"
    std::string version;
    std::string driver;
    int compute_units = 0;
    double memory_gib = 0;
    bool has_double = false;
};

struct BackendEntry {
    std::string name;
    std::function<std::unique_ptr<Backend>(const BackendOptions&)> make;
    std::function<std::vector<DeviceInfo>()> devices;
};

/// Every back end compiled into this build, in order of preference. Defined in `backends/all.cpp`,
/// which alone names them.
const std::vector<BackendEntry>& backend_registry();

/// Throws Error(unsupported) if `name` was not compiled in (naming those that were), and whatever
/// the back end throws when the device is missing (device_unavailable).
std::unique_ptr<Backend> make_backend(const std::string& name, const BackendOptions& options);

}  // namespace palpate
