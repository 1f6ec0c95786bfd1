// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "host/faces/cli/commands.hpp"
#include "solver/backend/registry.hpp"

namespace palpate {
namespace {

void print_device(const DeviceInfo& device) {
    fmt::print("{:<10} {:<6} {:<12} {:>4} {:>9} {:<7} {}\n", device.backend, device.id, device.type,
               device.compute_units,
               device.memory_gib > 0 ? fmt::format("{:.1f} GiB", device.memory_gib) : "-",
               device.has_double ? "yes" : "no", device.name);
    if (device.platform.empty()) return;
    fmt::print("{:<10} platform {}, {}, driver {}\n", "", device.platform, device.version,
               device.driver);
}

int run_devices() {
    fmt::print("{:<10} {:<6} {:<12} {:>4} {:>9} {:<7} {}\n", "backend", "device", "type", "CUs",
               "memory", "double", "name");
    bool any_opencl = false;
    for (const auto& entry : backend_registry()) {
        for (const auto& device : entry.devices()) {
            print_device(device);
            any_opencl = any_opencl || device.backend == "opencl";
        }
    }
    if (!any_opencl) {
        fmt::print(
            "no OpenCL device: install a GPU driver, or pocl-opencl-icd for the processor\n");
    }
    return 0;
}

}  // namespace

void add_devices(CLI::App& app, Run& run) {
    CLI::App* command = app.add_subcommand(
        "devices", "List what can compute, with the numbers that --device takes");
    command->callback([&run] { run = run_devices; });
}

}  // namespace palpate
