// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/context.hpp"

#include <fmt/format.h>

#include <map>
#include <mutex>

#include "solver/backends/opencl/device_choice.hpp"
#include "solver/backends/opencl/kept_signals.hpp"
#include "solver/backends/opencl/opencl_devices.hpp"
#include "solver/backends/opencl/pocl_environment.hpp"

namespace palpate {
namespace {

struct FoundDevice {
    DeviceInfo info;
    cl::Device device;
};

const char* type_name(cl_device_type type) {
    if (type & CL_DEVICE_TYPE_GPU) return "GPU";
    if (type & CL_DEVICE_TYPE_CPU) return "CPU";
    return "accelerator";
}

FoundDevice inspect(const cl::Platform& platform, const cl::Device& device, const std::string& id) {
    FoundDevice found;
    found.device = device;
    DeviceInfo& info = found.info;
    info.backend = "opencl";
    info.id = id;
    info.platform = platform.getInfo<CL_PLATFORM_NAME>();
    info.name = device.getInfo<CL_DEVICE_NAME>();
    info.type = type_name(device.getInfo<CL_DEVICE_TYPE>());
    info.version = device.getInfo<CL_DEVICE_VERSION>();
    info.driver = device.getInfo<CL_DRIVER_VERSION>();
    info.compute_units = static_cast<int>(device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>());
    info.memory_gib = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>() / (1024.0 * 1024.0 * 1024.0);
    info.has_double =
        device.getInfo<CL_DEVICE_EXTENSIONS>().find("cl_khr_fp64") != std::string::npos;
    return found;
}

std::vector<cl::Platform> find_platforms() {
    prepare_pocl_environment();
    std::vector<cl::Platform> platforms;
    try {
        cl::Platform::get(&platforms);
    } catch (const cl::Error&) {
        platforms.clear();  // the loader reports "no platform" as an error
    }
    return platforms;
}

std::vector<FoundDevice> find_devices() {
    const KeptSignals kept;
    std::vector<FoundDevice> found;
    const std::vector<cl::Platform> platforms = find_platforms();
    for (std::size_t p = 0; p < platforms.size(); ++p) {
        std::vector<cl::Device> devices;
        try {
            platforms[p].getDevices(CL_DEVICE_TYPE_ALL, &devices);
            for (std::size_t d = 0; d < devices.size(); ++d)
                found.push_back(inspect(platforms[p], devices[d], fmt::format("{}.{}", p, d)));
        } catch (const cl::Error&) {
            continue;  // a platform without (working) devices
        }
    }
    return found;
}

std::vector<DeviceInfo> infos_of(const std::vector<FoundDevice>& found) {
    std::vector<DeviceInfo> infos;
    for (const FoundDevice& f : found) infos.push_back(f.info);
    return infos;
}

std::shared_ptr<OpenclDevice> open(const FoundDevice& found) {
    auto opened = std::make_shared<OpenclDevice>();
    opened->info = found.info;
    opened->device = found.device;
    opened->is_cpu = found.info.type == "CPU";
    opened->has_double = found.info.has_double;
    opened->max_allocation = found.device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
    opened->context = cl::Context(found.device);
    opened->queue = cl::CommandQueue(opened->context, found.device);
    opened->programs =
        std::make_unique<ProgramCache>(opened->context, found.device, default_cache_folder());
    return opened;
}

}  // namespace

std::vector<DeviceInfo> opencl_devices() { return infos_of(find_devices()); }

std::shared_ptr<OpenclDevice> open_device(const std::string& wanted) {
    static std::mutex mutex;
    static auto* opened = new std::map<std::string, std::shared_ptr<OpenclDevice>>;
    const std::lock_guard<std::mutex> lock(mutex);
    return guarded("open the device", [&] {
        const std::vector<FoundDevice> found = find_devices();
        const FoundDevice& chosen = found[choose_device(infos_of(found), wanted)];
        std::shared_ptr<OpenclDevice>& device = (*opened)[chosen.info.id];
        if (!device) device = open(chosen);
        return device;
    });
}

}  // namespace palpate
