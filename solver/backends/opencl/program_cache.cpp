// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/program_cache.hpp"

#include <fmt/format.h>

#include "solver/backends/opencl/kept_signals.hpp"
#include "solver/backends/opencl/kernel_text.hpp"

namespace palpate {
namespace {

std::string options_text(const std::vector<Define>& defines) {
    std::string options = "-cl-std=CL1.2";  // never -cl-fast-relaxed-math: it hides NaN
    for (const Define& d : defines) options += fmt::format(" -D{}={}", d.name, d.value);
    return options;
}

std::string device_text(const cl::Device& device) {
    const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
    return fmt::format("{}\n{}\n{}\n{}\n{}\n", platform.getInfo<CL_PLATFORM_NAME>(),
                       platform.getInfo<CL_PLATFORM_VERSION>(), device.getInfo<CL_DEVICE_NAME>(),
                       device.getInfo<CL_DEVICE_VERSION>(), device.getInfo<CL_DRIVER_VERSION>());
}

std::string build_log(const cl::Program& program, const cl::Device& device) {
    try {
        return program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
    } catch (const cl::Error&) {
        return "(the driver gave no log)";
    }
}

ProgramBinary binary_of(const cl::Program& program) {
    try {
        const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
        return binaries.empty() ? ProgramBinary{} : binaries.front();
    } catch (const cl::Error&) {
        return {};  // a driver that gives no binaries: nothing is kept
    }
}

}  // namespace

ProgramCache::ProgramCache(cl::Context context, cl::Device device, std::filesystem::path folder)
    : context_(std::move(context)),
      device_(std::move(device)),
      folder_(std::move(folder)),
      device_key_(device_text(device_)) {}

std::string ProgramCache::key_of(const std::string& text,
                                 const std::vector<Define>& defines) const {
    return device_key_ + options_text(defines) + "\n" + text;
}

cl::Program ProgramCache::get(const std::string& program, std::string_view law,
                              const std::vector<Define>& defines) {
    return get_text(program, program_text(program, law), defines);
}

cl::Program ProgramCache::get_text(const std::string& name, const std::string& text,
                                   const std::vector<Define>& defines) {
    const std::string key = key_of(text, defines);
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto known = programs_.find(key);
    if (known != programs_.end()) return known->second;
    return programs_[key] = load_or_build(name, text, options_text(defines), key);
}

std::optional<std::string> ProgramCache::recall(const std::string& name) const {
    const std::optional<ProgramBinary> bytes = folder_.read(device_key_ + name);
    if (!bytes) return std::nullopt;
    return std::string(bytes->begin(), bytes->end());
}

void ProgramCache::note(const std::string& name, const std::string& text) const {
    folder_.write(device_key_ + name, ProgramBinary(text.begin(), text.end()));
}

ProgramCounts ProgramCache::counts() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return counts_;
}

cl::Program ProgramCache::load_or_build(const std::string& name, const std::string& text,
                                        const std::string& options, const std::string& key) {
    const KeptSignals kept;
    cl::Program program;
    if (load(options, key, program)) {
        ++counts_.loaded;
        return program;
    }
    program = build(name, text, options);
    ++counts_.built;
    folder_.write(key, binary_of(program));
    return program;
}

bool ProgramCache::load(const std::string& options, const std::string& key, cl::Program& program) {
    const std::optional<ProgramBinary> binary = folder_.read(key);
    if (!binary) return false;
    try {
        program = cl::Program(context_, {device_}, {*binary});
        program.build({device_}, options.c_str());
        return true;
    } catch (const cl::Error&) {
        folder_.remove(key);  // the driver does not take it: build from source, write it anew
        return false;
    }
}

cl::Program ProgramCache::build(const std::string& name, const std::string& text,
                                const std::string& options) {
    cl::Program program(context_, text);
    try {
        program.build({device_}, options.c_str());
    } catch (const cl::Error& error) {
        throw Error(
            ErrorCode::kernel_build_failed,
            fmt::format("The device program {} did not compile with \"{}\" ({}); try another "
                        "device or driver; the log says: {}",
                        name, options, opencl_status_name(error.err()),
                        build_log(program, device_)));
    }
    return program;
}

}  // namespace palpate
