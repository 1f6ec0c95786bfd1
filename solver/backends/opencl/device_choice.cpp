// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/device_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

template <class Rule>
std::size_t first_where(const std::vector<DeviceInfo>& devices, Rule rule) {
    return std::find_if(devices.begin(), devices.end(), rule) - devices.begin();
}

std::size_t best_device(const std::vector<DeviceInfo>& devices) {
    for (const char* type : {"GPU", "CPU"}) {
        const std::size_t found =
            first_where(devices, [&](const DeviceInfo& d) { return d.type == type; });
        if (found < devices.size()) return found;
    }
    return 0;
}

std::string list_of(const std::vector<DeviceInfo>& devices) {
    std::string text;
    for (const DeviceInfo& d : devices)
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", d.id, d.name);
    return text;
}

}  // namespace

std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& wanted) {
    if (devices.empty())
        throw Error(ErrorCode::device_unavailable,
                    "No OpenCL device was found: install pocl-opencl-icd (any processor) or the "
                    "driver of your GPU, then list the devices with `palpate devices`.");
    if (wanted.empty()) return best_device(devices);

    const std::size_t by_id =
        first_where(devices, [&](const DeviceInfo& d) { return d.id == wanted; });
    if (by_id < devices.size()) return by_id;
    const std::size_t by_name = first_where(devices, [&](const DeviceInfo& d) {
        return lower_case(d.name).find(lower_case(wanted)) != std::string::npos;
    });
    if (by_name < devices.size()) return by_name;
    throw Error(
        ErrorCode::device_unavailable,
        fmt::format("No OpenCL device matches \"{}\": there is {}; give the numbers or a part "
                    "of the name, or list the devices with `palpate devices`.",
                    wanted, list_of(devices)));
}

}  // namespace palpate
