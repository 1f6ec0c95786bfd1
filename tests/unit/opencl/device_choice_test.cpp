// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/device_choice.hpp"

#include <gtest/gtest.h>

#include "solver/backends/opencl/opencl_backend.hpp"
#include "solver/backends/opencl/opencl_devices.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

DeviceInfo device(const std::string& id, const std::string& name, const std::string& type) {
    DeviceInfo info;
    info.id = id;
    info.name = name;
    info.type = type;
    return info;
}

const std::vector<DeviceInfo> three_devices = {device("0.0", "Fast Chip 9000", "accelerator"),
                                               device("0.1", "Home Processor", "CPU"),
                                               device("1.0", "Game Card", "GPU")};

std::string message_of(const std::vector<DeviceInfo>& devices, const std::string& wanted) {
    try {
        choose_device(devices, wanted);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::device_unavailable);
        return error.what();
    }
    return "no error";
}

TEST(ChooseDevice, PrefersGpuThenCpuThenWhateverThereIs) {
    EXPECT_EQ(choose_device(three_devices, ""), 2u);
    EXPECT_EQ(choose_device({three_devices[0], three_devices[1]}, ""), 1u);
    EXPECT_EQ(choose_device({three_devices[0]}, ""), 0u);
}

TEST(ChooseDevice, TakesNumbersOrPartOfNameInAnyCase) {
    EXPECT_EQ(choose_device(three_devices, "0.1"), 1u);
    EXPECT_EQ(choose_device(three_devices, "1.0"), 2u);
    EXPECT_EQ(choose_device(three_devices, "home PROC"), 1u);
    EXPECT_EQ(choose_device(three_devices, "9000"), 0u);
}

TEST(ChooseDevice, SaysWhatToInstallWhenThereIsNoDevice) {
    for (const char* wanted : {"", "0.0"}) {
        const std::string message = message_of({}, wanted);
        EXPECT_NE(message.find("pocl-opencl-icd"), std::string::npos) << message;
        EXPECT_NE(message.find("palpate devices"), std::string::npos) << message;
    }
}

TEST(ChooseDevice, ListsWhatThereIsWhenNothingMatches) {
    for (const char* wanted : {"2.0", "quantum"}) {
        const std::string message = message_of(three_devices, wanted);
        EXPECT_NE(message.find(wanted), std::string::npos) << message;
        EXPECT_NE(message.find("1.0 (Game Card)"), std::string::npos) << message;
    }
}

TEST(OpenclDevices, ThatAreListedCanBeOpenedByTheirNumbers) {
    const std::vector<DeviceInfo> devices = opencl_devices();
    if (devices.empty()) GTEST_SKIP() << "This machine has no OpenCL device.";
    for (const DeviceInfo& info : devices) {
        BackendOptions options;
        options.device = info.id;

        const BackendInfo described = make_opencl_backend(options)->describe();

        EXPECT_EQ(described.backend, "opencl");
        EXPECT_EQ(described.device, info.name);
        EXPECT_GT(described.compute_units, 0);
        EXPECT_GT(info.memory_gib, 0);
    }
}

TEST(OpenclDevices, UnknownDeviceIsUnavailable) {
    BackendOptions options;
    options.device = "no such device";
    try {
        make_opencl_backend(options);
        FAIL() << "a device was found";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::device_unavailable);
    }
}

}  // namespace
}  // namespace palpate
